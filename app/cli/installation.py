"""The database and the photographs of an installation, for commands that work beside the service or without it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from app.cli.migrate import open_database

if TYPE_CHECKING:
    from app.settings import Settings
    from app.storage.database import Database
    from app.storage.photo_store import PhotoStore


@dataclass(frozen=True)
class Installation:
    """What one installation has stored."""

    database: Database
    photos: PhotoStore


@contextmanager
def installation(settings: Settings) -> Iterator[Installation]:
    """The stores of an installation, closed when the block ends.

    Raises
    ------
    InvalidInput
        When the settings name no usable database or store.
    """
    from app.storage.photo_store import open_photo_store

    database = open_database(settings)
    try:
        yield Installation(database, open_photo_store(settings.photographs_location))
    finally:
        database.close()
