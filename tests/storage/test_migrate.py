"""Migrations and models say the same, forward and back."""

from __future__ import annotations

from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import inspect, text

from app.storage.database import Database
from app.storage.migrate import COMPARISON, downgrade, migrations_folder, up_to_date, upgrade
from app.storage.models import Base
from app.storage.sites import SiteRepository
from tests.storage.examples import site_with_survey

VERSION_TABLE = "alembic_version"


def tables(database: Database) -> set[str]:
    with database.reading() as session:
        return set(inspect(session.connection()).get_table_names())


def difference(database: Database) -> list[object]:
    """What a migration that Alembic wrote would do now, with the comparison that it would make."""
    with database.reading() as session:
        context = MigrationContext.configure(session.connection(), opts=COMPARISON)
        return list(compare_metadata(context, Base.metadata))


def test_migrations_and_models_agree(database: Database) -> None:
    assert difference(database) == []
    assert tables(database) == {*Base.metadata.tables, VERSION_TABLE}


def test_tables_of_others_are_not_seen(empty_database: Database) -> None:
    """A job engine keeps its own beside ours: on Postgres in a schema, on SQLite in the same file."""
    upgrade(empty_database)
    foreign = ["CREATE TABLE workflow_status (id INTEGER)"]
    if empty_database.url.startswith("postgresql"):
        foreign += [
            "CREATE SCHEMA dbos",
            "CREATE TABLE dbos.workflow_status (id INTEGER)",
            "CREATE TABLE dbos.sites (id INTEGER)",
        ]
    with empty_database.migrating() as connection:
        for statement in foreign:
            connection.execute(text(statement))
    assert difference(empty_database) == []


def test_a_column_that_no_migration_made_is_seen(empty_database: Database) -> None:
    upgrade(empty_database)
    with empty_database.migrating() as connection:
        connection.execute(text("ALTER TABLE sites ADD COLUMN colour VARCHAR(10)"))
    assert "colour" in str(difference(empty_database))


def test_forward_again_changes_nothing(database: Database) -> None:
    site, _ = site_with_survey(database)
    assert up_to_date(database)
    upgrade(database)
    with database.reading() as session:
        assert SiteRepository(session).get(site.site_id) == site


def test_back_step_by_step_and_forward(empty_database: Database) -> None:
    upgrade(empty_database)
    for _ in ScriptDirectory(str(migrations_folder())).walk_revisions():
        assert tables(empty_database) > {VERSION_TABLE}
        downgrade(empty_database, "-1")
        assert not up_to_date(empty_database)
    assert tables(empty_database) == {VERSION_TABLE}
    upgrade(empty_database)
    assert up_to_date(empty_database)
    assert difference(empty_database) == []


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
