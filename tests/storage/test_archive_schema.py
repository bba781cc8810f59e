"""The tables of a revision are those that its migrations make; each table is kept or left out on purpose."""

from __future__ import annotations

import pytest
from sqlalchemy import text

from app.storage.archive_rows import RowForm
from app.storage.archive_schema import (
    TRANSIENT,
    current_revision,
    kept_tables,
    known_revisions,
    revision_of,
    tables_at,
)
from app.storage.backup_rows import PHOTO_COLUMNS
from app.storage.database import Database
from app.storage.migrate import WrongTables, upgrade
from app.storage.models import Base


def test_the_newest_tables_are_those_of_the_models() -> None:
    newest = tables_at(known_revisions()[0])
    assert set(newest.tables) == set(Base.metadata.tables)
    for name, table in Base.metadata.tables.items():
        assert {column.name for column in table.columns} == set(RowForm(newest.tables[name]).columns)


def test_what_is_left_out_is_there_to_be_left_out() -> None:
    assert set(Base.metadata.tables) >= TRANSIENT
    kept = {table.name for table in kept_tables(tables_at(known_revisions()[0]))}
    assert kept == set(Base.metadata.tables) - TRANSIENT


def test_every_column_that_holds_a_photographs_digest_is_known() -> None:
    """A new one must be named, or its photographs are missing from backups."""
    # A detection may outlive its photograph; what was sent is not what is kept.
    of_others = {("detections", "sha256"), ("photographs", "sent_sha256")}
    digests = {
        (table.name, column.name)
        for table in Base.metadata.tables.values()
        for column in table.columns
        if "sha256" in column.name
    }
    assert digests - of_others == set(PHOTO_COLUMNS)


def test_tables_come_after_those_that_they_refer_to() -> None:
    names = [table.name for table in kept_tables(tables_at(known_revisions()[0]))]
    assert names.index("sites") < names.index("trajectories") < names.index("snapshots")
    assert names.index("target_maps") < names.index("mapped_targets")


def test_an_older_revision_has_its_own_tables() -> None:
    assert "ordinal" not in tables_at("0001").tables["snapshots"].columns
    assert "ordinal" in tables_at("0002").tables["snapshots"].columns


def test_the_revision_of_a_database(empty_database: Database) -> None:
    with empty_database.reading() as session:
        assert revision_of(session.connection()) is None
        with pytest.raises(WrongTables, match="no tables"):
            current_revision(session.connection())
    upgrade(empty_database, "0003")
    with empty_database.reading() as session:
        assert current_revision(session.connection()) == "0003"


def test_a_revision_of_the_future(database: Database) -> None:
    with database.writing() as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    try:
        with database.reading() as session, pytest.raises(WrongTables, match="9999"):
            current_revision(session.connection())
    finally:
        with database.writing() as session:
            session.execute(text("UPDATE alembic_version SET version_num = :now"), {"now": known_revisions()[0]})
