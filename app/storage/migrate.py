"""Bring a database to the present tables, and say whether it is there."""

from __future__ import annotations

from importlib.resources import as_file, files
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection

from app.errors import ScattermarkError
from app.storage.database import Database
from app.storage.models import Base


class WrongTables(ScattermarkError):
    """The database waits for a migration, or had one that this release does not know."""

    slug = "wrong-tables"


def ours(name: str | None, kind: str, _parents: object) -> bool:
    """Whether something in the database is the project's: a job engine may keep its own tables beside ours."""
    return kind != "table" or name in Base.metadata.tables


# How a database is compared with the models, for a new migration and for the test that none is missing.
COMPARISON: dict[str, Any] = {"include_name": ours, "compare_type": True}


def migrations_folder() -> Path:
    """Where the migrations are: inside an installed package, or beside it in a checkout.

    Raises
    ------
    FileNotFoundError
        When the installation is incomplete.
    """
    package = files("app")
    with as_file(package) as package_folder:
        for folder in (package_folder / "_migrations", package_folder.parent / "migrations"):
            if (folder / "env.py").is_file():
                return folder
    raise FileNotFoundError("the migrations are missing from this installation; install scattermark again")


def upgrade(database: Database, revision: str = "head") -> None:
    """Bring the database up to a revision; nothing happens when it is there."""
    with database.migrating() as connection:
        upgrade_on(connection, revision)


def upgrade_on(connection: Connection, revision: str = "head") -> None:
    """``upgrade`` within a transaction of ``Database.migrating`` that does more than this."""
    command.upgrade(_config(connection), revision)


def downgrade(database: Database, revision: str) -> None:
    """Take the database back to a revision; ``base`` removes all tables."""
    with database.migrating() as connection:
        command.downgrade(_config(connection), revision)


def up_to_date(database: Database) -> bool:
    """Whether the database has the newest tables."""
    newest = ScriptDirectory(str(migrations_folder())).get_current_head()
    with database.reading() as session:
        return MigrationContext.configure(session.connection()).get_current_revision() == newest


def check_tables(database: Database) -> None:
    """See that the database is one that this release can work with.

    Raises
    ------
    WrongTables
        When it has other tables.
    StorageUnavailable
        When it gives no answer.
    """
    if not up_to_date(database):
        raise WrongTables("the database's tables are not those of this release: run `scattermark migrate`")


def _config(connection: object) -> Config:
    config = Config()
    config.set_main_option("script_location", str(migrations_folder()).replace("%", "%%"))
    config.attributes["connection"] = connection
    return config
