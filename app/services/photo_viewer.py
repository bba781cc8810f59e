"""The story of one photograph that somebody looks at: its bytes, a smaller picture, what was seen in it."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass

from app.errors import BadPhoto
from app.geometry.observations import Detection
from app.services.build_options import BuildOptions, Strictness
from app.services.detect_work import DetectSettings, DetectTask, detect_photo
from app.services.ports import CpuPool
from app.services.show_work import ShowTask, show_photo, turns_of_photo
from app.storage.database import Database
from app.storage.photo_store import PhotoStore
from app.storage.records import StoredPhoto
from app.storage.sites import SiteRepository
from app.storage.surveys import DetectionRepository, SurveyRepository
from app.vision.display import DisplayOptions
from app.vision.photo import PhotoLimits, read_header


@dataclass(frozen=True)
class ViewLimits:
    """What a photograph may be, and how long it may take to show it and to look for targets in it."""

    photo: PhotoLimits
    show_timeout_s: float
    detect_timeout_s: float


@dataclass(frozen=True)
class OriginalPhoto:
    """A photograph as it is stored, and its format as ``app.vision.photo`` names it."""

    data: bytes
    format: str


@dataclass(frozen=True)
class SeenPhoto:
    """What was seen in a photograph.

    Attributes
    ----------
    quarter_turns : int
        Clockwise, to show it upright; coordinates are of the picture as the sensor's rows lie.
    """

    photo: StoredPhoto
    detection: Detection
    quarter_turns: int


class PhotoViewer:
    """Shows photographs of surveys; pixels are the pool's business."""

    def __init__(self, database: Database, photos: PhotoStore, pool: CpuPool, limits: ViewLimits) -> None:
        self._database = database
        self._photos = photos
        self._pool = pool
        self._limits = limits

    async def find(self, survey_id: str, name: str) -> StoredPhoto:
        """A photograph of a survey.

        Raises
        ------
        NotFound
        """
        return await asyncio.to_thread(self._find, survey_id, name)

    async def original(self, photo: StoredPhoto) -> OriginalPhoto:
        """A photograph as it is stored.

        Raises
        ------
        NotFound, StorageUnavailable
            When the store has lost it, or cannot be reached.
        """
        data = await asyncio.to_thread(self._photos.read, photo.sha256)
        return OriginalPhoto(data, read_header(data, self._limits.photo).format)

    async def picture(self, photo: StoredPhoto, options: DisplayOptions) -> bytes:
        """A photograph as a JPEG to look at.

        Raises
        ------
        NotFound, StorageUnavailable, ServerFull, TimedOut, WorkerCrashed
            When it cannot be had now.
        """
        task = ShowTask(photo.sha256, options, self._limits.photo)
        shown: bytes = await self._pool.run(show_photo, task, timeout_s=self._limits.show_timeout_s)
        return shown

    async def seen(self, survey_id: str, name: str, strictness: Strictness) -> SeenPhoto:
        """What was seen in a photograph; it is looked at now if nobody did.

        Raises
        ------
        NotFound
            When there is no such photograph.
        BadPhoto
            When no detector can read it.
        ServerFull, TimedOut, WorkerCrashed
            When it cannot be looked at now.
        """
        photo = await self.find(survey_id, name)
        settings, detection = await asyncio.to_thread(self._kept, survey_id, photo, strictness)
        if detection is None:
            task = DetectTask(photo.sha256, settings, self._limits.photo)
            reason = await self._pool.run(detect_photo, task, timeout_s=self._limits.detect_timeout_s)
            if reason is not None:
                raise BadPhoto(f"{name}: {reason}", filename=name)
            _, detection = await asyncio.to_thread(self._kept, survey_id, photo, strictness)
        assert detection is not None  # it was kept just now
        turns = await self._pool.run(turns_of_photo, photo.sha256, timeout_s=self._limits.show_timeout_s)
        return SeenPhoto(photo, detection, turns)

    def _find(self, survey_id: str, name: str) -> StoredPhoto:
        with self._database.reading() as session:
            return SurveyRepository(session).photo(survey_id, name)

    def _kept(
        self, survey_id: str, photo: StoredPhoto, strictness: Strictness
    ) -> tuple[DetectSettings, Detection | None]:
        with self._database.reading() as session:
            site_id = SurveyRepository(session).get(survey_id).site_id
            family = SiteRepository(session).get(site_id).code_family
            settings = DetectSettings.of(family, BuildOptions(strictness=strictness))
            return settings, DetectionRepository(session).get(settings.key(photo.sha256))
