"""Surveys and their photographs: looked at on arrival, stored whole, safe to send again."""

from __future__ import annotations

import asyncio
import re
import time
import unicodedata
from collections.abc import AsyncIterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

from sqlalchemy.orm import Session

from app.errors import InvalidInput, ScattermarkError
from app.storage.database import Database
from app.storage.photo_store import IncomingPhoto, PhotoStore
from app.storage.records import StoredPhoto, Survey
from app.storage.surveys import SurveyRepository
from app.vision.photo import PhotoLimits, read_header

# A name is a label, never a path: letters and digits of any script, and what cameras and people put between them.
FILENAME = re.compile(r"\w[\w .()+,@~=-]{0,149}")


@dataclass(frozen=True)
class ArrivedPhoto:
    """A photograph that has been received and looked at, not yet kept."""

    photo: StoredPhoto
    incoming: IncomingPhoto


@dataclass(frozen=True)
class AddedPhoto:
    """A photograph of the survey; ``created`` is False when the same bytes were there."""

    photo: StoredPhoto
    created: bool


def open_survey(session: Session, site_id: str, note: str, device_id: str | None) -> Survey:
    """A survey, open for photographs.

    Raises
    ------
    NotFound
        When there is no such site.
    """
    return SurveyRepository(session).add(site_id, note, device_id)


def checked_filename(filename: str) -> str:
    """A photograph's name in composed form.

    Raises
    ------
    InvalidInput
        When it is empty, too long, a path, or holds characters that a name has no need of.
    """
    name = unicodedata.normalize("NFC", filename)
    if not FILENAME.fullmatch(name):
        raise InvalidInput(
            f"{filename[:150]!r} is no usable file name: letters, digits, spaces and .()+,@~=-_ are, 150 at the most, "
            "beginning with a letter, digit or underscore and without folders",
            field="filename",
        )
    return name


def _inspect(name: str, incoming: IncomingPhoto, limits: PhotoLimits) -> ArrivedPhoto:
    """Look at a received photograph's header before anything is kept; an error names the file."""
    try:
        header = read_header(incoming.content(), limits)
    except ScattermarkError as error:
        raise type(error)(f"{name}: {error.detail}", **{**error.fields, "filename": name}) from error
    photo = StoredPhoto(
        name=name,
        sha256=incoming.sha256,
        size_bytes=incoming.size_bytes,
        sent_sha256=incoming.sha256,
        sent_bytes=incoming.size_bytes,
        identity=header.identity,
        captured_at=header.captured_at,
        created_s=time.time(),
    )
    return ArrivedPhoto(photo, incoming)


class PhotoIntake:
    """Takes photographs into a survey: streamed to disk, looked at, then kept and listed together.

    Parameters
    ----------
    database : Database
    photos : PhotoStore
    limits : PhotoLimits
    """

    def __init__(self, database: Database, photos: PhotoStore, limits: PhotoLimits) -> None:
        self._database = database
        self._photos = photos
        self._limits = limits

    async def take(self, survey_id: str, files: Sequence[tuple[str, AsyncIterable[bytes]]]) -> tuple[AddedPhoto, ...]:
        """Add photographs to a survey, all or none; nothing is left of what breaks off.

        Raises
        ------
        NotFound
            When there is no such survey.
        InvalidInput, BadPhoto, UnsupportedPhoto, PhotoTooLarge
            For a photograph that no survey can use; the error names it.
        Conflict
            When a name is taken by other bytes.
        """
        await asyncio.to_thread(self._check_survey, survey_id)
        with ExitStack() as arriving:
            arrived = []
            for filename, chunks in files:
                name = checked_filename(filename)
                incoming = arriving.enter_context(self._photos.receive(self._limits.max_bytes))
                async for chunk in chunks:
                    await asyncio.to_thread(incoming.write, chunk)
                arrived.append(await asyncio.to_thread(_inspect, name, incoming, self._limits))
            return await asyncio.to_thread(self._add, survey_id, arrived)

    def _check_survey(self, survey_id: str) -> None:
        with self._database.reading() as session:
            SurveyRepository(session).get(survey_id)

    def _add(self, survey_id: str, arrived: Sequence[ArrivedPhoto]) -> tuple[AddedPhoto, ...]:
        with self._database.writing() as session:
            surveys = SurveyRepository(session)
            added = tuple(AddedPhoto(item.photo, surveys.add_photo(survey_id, item.photo)) for item in arrived)
            # Files last: when one cannot be written the rows are undone; a file without a row harms nobody.
            for item in arrived:
                self._photos.put(item.photo.sha256, item.incoming.content())
        return added
