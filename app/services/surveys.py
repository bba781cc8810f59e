"""Surveys and their photographs: looked at on arrival, stored whole, safe to send again."""

from __future__ import annotations

import asyncio
import hashlib
import re
import time
import unicodedata
from collections.abc import AsyncIterable, AsyncIterator, Awaitable, Callable, Sequence
from contextlib import ExitStack, asynccontextmanager
from dataclasses import dataclass

from sqlalchemy.orm import Session

from app.errors import InvalidInput, ScattermarkError
from app.services.storage_budget import StorageBudget
from app.storage.database import Database
from app.storage.incoming_photo import IncomingPhoto
from app.storage.photo_references import lock_photos
from app.storage.photo_store import PhotoStore
from app.storage.records import StoredPhoto, Survey
from app.storage.surveys import SurveyRepository
from app.vision.photo import PhotoLimits, read_header
from app.vision.privacy.without_position import without_position

Notice = Callable[[str], Awaitable[None]]

# A name is a label, never a path: letters and digits of any script, and what cameras and people put between them.
FILENAME = re.compile(r"\w[\w .()+,@~=-]{0,149}")


class DigestMismatch(InvalidInput):
    """Bytes that are not those which the client announced."""

    slug = "digest-mismatch"


@dataclass(frozen=True)
class Upload:
    """A photograph that a client sends.

    Attributes
    ----------
    filename : str
    chunks : async iterable of bytes
    size_bytes : int
        What the client announces; 0 when it does not.
    sha256 : str or None
        Digest that the client announces.
    """

    filename: str
    chunks: AsyncIterable[bytes]
    size_bytes: int = 0
    sha256: str | None = None


@dataclass(frozen=True)
class ArrivedPhoto:
    """A photograph that has been received and looked at, not yet kept."""

    photo: StoredPhoto
    incoming: IncomingPhoto

    def content(self) -> bytes:
        """What is stored of it."""
        return without_position(self.incoming.content())


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


class PhotoIntake:
    """Takes photographs into a survey: received, looked at, stored without position, then listed together.

    Parameters
    ----------
    database : Database
    photos : PhotoStore
    limits : PhotoLimits
    budget : StorageBudget
    noticed : callable, optional
        Told the survey that photographs came into.
    """

    def __init__(
        self,
        database: Database,
        photos: PhotoStore,
        limits: PhotoLimits,
        budget: StorageBudget,
        noticed: Notice | None = None,
    ) -> None:
        self._database = database
        self._photos = photos
        self._limits = limits
        self._budget = budget
        self._noticed = noticed

    @property
    def store(self) -> PhotoStore:
        """Where photographs go."""
        return self._photos

    async def take(self, survey_id: str, uploads: Sequence[Upload]) -> tuple[AddedPhoto, ...]:
        """Add photographs to a survey, all or none; nothing is left of what breaks off.

        Raises
        ------
        NotFound
            When there is no such survey.
        InvalidInput, BadPhoto, UnsupportedPhoto, PhotoTooLarge
            For a photograph that no survey can use, or that is not the one that was sent; the error names it.
        Conflict
            When a name is taken by other bytes.
        OutOfSpace, StorageUnavailable
            When they cannot be stored; nothing of them is.
        """
        await asyncio.to_thread(self._check_survey, survey_id)
        async with self._received(uploads) as arrived:
            await asyncio.to_thread(self._store_new, survey_id, arrived)
            added = await asyncio.to_thread(self._add, survey_id, arrived)
        if self._noticed is not None:
            await self._noticed(survey_id)
        return added

    @asynccontextmanager
    async def arriving(self, uploads: Sequence[Upload]) -> AsyncIterator[tuple[ArrivedPhoto, ...]]:
        """Photographs received, looked at and stored, for whoever lists them by ``list_in`` within the block.

        Raises
        ------
        InvalidInput, BadPhoto, UnsupportedPhoto, PhotoTooLarge, OutOfSpace, StorageUnavailable
            As ``take``.
        """
        async with self._received(uploads) as arrived:
            await asyncio.to_thread(self._store, arrived)
            yield arrived

    def list_in(self, session: Session, survey_id: str, arrived: Sequence[ArrivedPhoto]) -> tuple[AddedPhoto, ...]:
        """List stored photographs in a survey.

        Raises
        ------
        Conflict
            When a name is taken by other bytes.
        """
        lock_photos(session, [item.photo.sha256 for item in arrived])
        surveys = SurveyRepository(session)
        added = tuple(AddedPhoto(item.photo, surveys.add_photo(survey_id, item.photo)) for item in arrived)
        for item in arrived:
            # A purge may have taken the file while no row referred to it; from here on it cannot.
            if not self._photos.holds(item.photo.sha256):
                self._photos.put(item.photo.sha256, item.content())
        return added

    @asynccontextmanager
    async def _received(self, uploads: Sequence[Upload]) -> AsyncIterator[tuple[ArrivedPhoto, ...]]:
        await asyncio.to_thread(self._budget.admit, sum(upload.size_bytes for upload in uploads))
        with ExitStack() as arriving:
            yield tuple([await self._receive(upload, arriving) for upload in uploads])

    async def _receive(self, upload: Upload, arriving: ExitStack) -> ArrivedPhoto:
        name = checked_filename(upload.filename)
        incoming = arriving.enter_context(self._photos.receive(self._limits.max_bytes))
        async for chunk in upload.chunks:
            await asyncio.to_thread(incoming.write, chunk)
        _check_digest(name, upload.sha256, incoming.sha256)
        return await asyncio.to_thread(_inspect, name, incoming, self._limits)

    def _check_survey(self, survey_id: str) -> None:
        with self._database.reading() as session:
            SurveyRepository(session).get(survey_id)

    def _store_new(self, survey_id: str, arrived: Sequence[ArrivedPhoto]) -> None:
        """Store what the survey has not yet."""
        with self._database.reading() as session:
            surveys = SurveyRepository(session)
            new = [item for item in arrived if not surveys.has_photo(survey_id, item.photo)]
        self._store(new)

    def _store(self, new: Sequence[ArrivedPhoto]) -> None:
        """Put photographs into the store, before any row refers to them and outside of any transaction."""
        self._budget.admit(sum(item.photo.size_bytes for item in new))
        for item in new:
            self._photos.put(item.photo.sha256, item.content())

    def _add(self, survey_id: str, arrived: Sequence[ArrivedPhoto]) -> tuple[AddedPhoto, ...]:
        with self._database.writing() as session:
            return self.list_in(session, survey_id, arrived)


def _check_digest(name: str, announced: str | None, arrived: str) -> None:
    if announced is not None and announced != arrived:
        raise DigestMismatch(
            f"{name}: other bytes arrived than were announced (SHA-256 {arrived}, announced {announced}); "
            "send the photograph again",
            filename=name,
            sha256=arrived,
        )


def _inspect(name: str, incoming: IncomingPhoto, limits: PhotoLimits) -> ArrivedPhoto:
    """Look at a received photograph's header before anything is kept; an error names the file."""
    content = incoming.content()
    try:
        header = read_header(content, limits)
    except ScattermarkError as error:
        raise type(error)(f"{name}: {error.detail}", **{**error.fields, "filename": name}) from error
    stored = without_position(content)
    photo = StoredPhoto(
        name=name,
        sha256=incoming.sha256 if stored is content else hashlib.sha256(stored).hexdigest(),
        size_bytes=len(stored),
        sent_sha256=incoming.sha256,
        sent_bytes=incoming.size_bytes,
        identity=header.identity,
        captured_at=header.captured_at,
        created_s=time.time(),
    )
    return ArrivedPhoto(photo, incoming)
