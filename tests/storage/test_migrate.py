"""Migrations and models say the same, forward and back."""

from __future__ import annotations

from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from sqlalchemy import inspect, text

from app.storage.database import Database
from app.storage.migrate import downgrade, migrations_folder, up_to_date, upgrade
from app.storage.models import Base
from app.storage.sites import SiteRepository
from tests.storage.examples import site_with_survey

VERSION_TABLE = "alembic_version"


def tables(database: Database) -> set[str]:
    with database.reading() as session:
        return set(inspect(session.connection()).get_table_names())


def test_migrations_and_models_agree(database: Database) -> None:
    with database.reading() as session:
        context = MigrationContext.configure(session.connection(), opts={"compare_type": True})
        assert compare_metadata(context, Base.metadata) == []
    assert tables(database) == {*Base.metadata.tables, VERSION_TABLE}


def test_forward_again_changes_nothing(database: Database) -> None:
    site, _ = site_with_survey(database)
    assert up_to_date(database)
    upgrade(database)
    with database.reading() as session:
        assert SiteRepository(session).get(site.site_id) == site


def test_back_to_nothing_and_forward(database: Database) -> None:
    downgrade(database, "base")
    assert tables(database) == {VERSION_TABLE}
    assert not up_to_date(database)
    upgrade(database)
    assert up_to_date(database)


def test_a_new_database_is_not_up_to_date(empty_database: Database) -> None:
    assert not up_to_date(empty_database)


def test_foreign_keys_hold_after_migrating(database: Database) -> None:
    with database.writing() as session:
        if session.get_bind().dialect.name == "sqlite":
            assert session.execute(text("PRAGMA foreign_keys")).scalar() == 1


def test_all_that_a_migration_needs_is_in_one_folder() -> None:
    folder = migrations_folder()
    assert (folder / "env.py").is_file()
    assert (folder / "script.py.mako").is_file()
    assert list((folder / "versions").glob("*.py"))
