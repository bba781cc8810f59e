"""``scattermark migrate``: bring a database to the tables of this version."""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING

from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.settings import Settings
    from app.storage.database import Database

HELP = "bring the database (SCATTERMARK_DATABASE_URL) to the tables of this version"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("--data-dir", type=Path, help="folder of the embedded database (SCATTERMARK_DATA_DIR)")


def run(arguments: argparse.Namespace) -> int:
    """Upgrade and say so."""
    migrate(settings_of(arguments.data_dir))
    print("the database is up to date")
    return 0


def settings_of(data_dir: Path | None) -> Settings:
    """Settings of the environment, with the folder that the command line names."""
    from app.settings import settings_from_environment

    settings = settings_from_environment()
    return settings if data_dir is None else dataclasses.replace(settings, data_dir=data_dir)


def migrate(settings: Settings) -> None:
    """Bring the database to the tables of this version; make the embedded one when there is none.

    Raises
    ------
    InvalidInput
        When the URL names no usable database.
    StorageUnavailable
        When the database gives no answer.
    """
    from alembic.util import CommandError
    from sqlalchemy.exc import DatabaseError

    from app.storage.migrate import upgrade

    if settings.embedded:
        settings.data_dir.mkdir(parents=True, exist_ok=True)
    database = open_database(settings)
    try:
        upgrade(database)
    except DatabaseError as error:
        elsewhere = "point SCATTERMARK_DATABASE_URL or --data-dir elsewhere"
        raise InvalidInput(f"the database cannot be used ({error.orig}): {elsewhere}") from error
    except CommandError as error:
        raise InvalidInput(f"the database belongs to another version of Scattermark: {error}") from error
    finally:
        database.close()


def open_database(settings: Settings) -> Database:
    """The database that settings name; it connects when first used.

    Raises
    ------
    InvalidInput
        When the URL is none, or its driver is not installed.
    """
    from sqlalchemy.exc import ArgumentError

    from app.storage.database import Database

    try:
        return Database(settings.sqlalchemy_url)
    except ArgumentError as error:
        raise InvalidInput(f"SCATTERMARK_DATABASE_URL={settings.database_url!r}: {error}") from error
    except ModuleNotFoundError as error:
        raise InvalidInput(f"the database's driver is missing: install {error.name} (scattermark[postgres])") from error
