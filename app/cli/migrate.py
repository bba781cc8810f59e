"""``scattermark migrate``: bring a database to the tables of this version."""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path

HELP = "bring the database (SCATTERMARK_DATABASE_URL) to the tables of this version"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("--data-dir", type=Path, help="folder of the embedded database (SCATTERMARK_DATA_DIR)")


def run(arguments: argparse.Namespace) -> int:
    """Upgrade and say so."""
    from app.settings import settings_from_environment
    from app.storage.database import Database
    from app.storage.migrate import upgrade

    settings = settings_from_environment()
    if arguments.data_dir is not None:
        settings = dataclasses.replace(settings, data_dir=arguments.data_dir)
    if settings.embedded:
        settings.data_dir.mkdir(parents=True, exist_ok=True)
    database = Database(settings.sqlalchemy_url)
    try:
        upgrade(database)
    finally:
        database.close()
    print("the database is up to date")
    return 0
