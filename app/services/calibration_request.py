"""A calibration is asked for: its photographs come in with it, and it becomes a job that a worker finds."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from sqlalchemy.orm import Session

from app.errors import Conflict, InvalidInput, NotFound
from app.photogrammetry.calibration.adjust import FEWEST_PHOTOS
from app.services.job_kinds import CALIBRATE
from app.services.surveys import PhotoIntake, Upload
from app.storage.database import Database
from app.storage.jobs import Job, JobRepository
from app.storage.records import Site
from app.storage.sites import SiteRepository
from app.storage.surveys import SurveyRepository

log = logging.getLogger(__name__)

MOST_PHOTOS = 60  # 5 to 20 are enough; what is far more was meant for a survey
NOTE = "photographs that calibrate a camera"


@dataclass(frozen=True)
class CalibrationWish:
    """What can be said of a calibration.

    Attributes
    ----------
    site_id : str
        Whose active map the photographs show.
    survey_id : str or None
        Of the site, that holds the photographs; None when they come with the wish.
    device_id : str or None
        Whose camera it is; without it any device of the model may be this one.
    readout_s : float or None
        Of the sensor's rows, where it is known: it cannot be measured from pictures of things that stand still.
    """

    site_id: str
    survey_id: str | None = None
    device_id: str | None = None
    readout_s: float | None = None


@dataclass(frozen=True)
class CalibrationOptions:
    """A calibration as its job's row keeps it."""

    map_version: int
    device_id: str | None
    readout_s: float | None

    def to_json(self) -> dict[str, Any]:
        """A record for the job's row."""
        return asdict(self)

    @classmethod
    def from_json(cls, record: dict[str, Any]) -> CalibrationOptions:
        """The options that ``to_json`` wrote."""
        return cls(**record)


class CalibrationDesk:
    """Takes calibrations."""

    def __init__(self, database: Database, intake: PhotoIntake) -> None:
        self._database = database
        self._intake = intake

    async def take(self, wish: CalibrationWish, uploads: Sequence[Upload]) -> Job:
        """Put a calibration in the queue, by the photographs of a survey or by those that come with the wish.

        Raises
        ------
        NotFound
            When there is no such site, or no such survey of it.
        Conflict
            When the site has no map.
        InvalidInput
            When the photographs are too few or too many, or come both ways.
        """
        if wish.survey_id is None:
            return await self._with_uploads(wish, uploads)
        if uploads:
            raise InvalidInput("name a survey or send photographs, not both", field="survey_id")
        return await asyncio.to_thread(self._by_survey, wish, wish.survey_id)

    def _by_survey(self, wish: CalibrationWish, survey_id: str) -> Job:
        with self._database.writing() as session:
            surveys = SurveyRepository(session)
            if surveys.get(survey_id).site_id != wish.site_id:
                raise NotFound(f"the site has no survey {survey_id}", survey_id=survey_id)
            _check_count(surveys.photo_count(survey_id))
            return _queued(session, wish, survey_id)

    async def _with_uploads(self, wish: CalibrationWish, uploads: Sequence[Upload]) -> Job:
        """Keep the photographs, as a survey of their own, and put the calibration in the queue: all or nothing.

        Raises
        ------
        NotFound
            When there is no such site.
        Conflict
            When the site has no map, or two photographs have one name.
        InvalidInput, BadPhoto, UnsupportedPhoto, PhotoTooLarge
            When the photographs are too few or too many, or one is none; the error names it.
        OutOfSpace, StorageUnavailable
            When they cannot be stored; nothing of them is.
        """
        _check_count(len(uploads))
        await asyncio.to_thread(self._check_site, wish.site_id)
        async with self._intake.arriving(uploads) as arrived:

            def write() -> Job:
                with self._database.writing() as session:
                    survey_id = SurveyRepository(session).add(wish.site_id, NOTE, wish.device_id).survey_id
                    self._intake.list_in(session, survey_id, arrived)
                    return _queued(session, wish, survey_id)

            return await asyncio.to_thread(write)

    def _check_site(self, site_id: str) -> None:
        with self._database.reading() as session:
            _version(SiteRepository(session).get(site_id))


def _queued(session: Session, wish: CalibrationWish, survey_id: str) -> Job:
    version = _version(SiteRepository(session).get(wish.site_id))
    options = CalibrationOptions(version, wish.device_id, wish.readout_s)
    job = JobRepository(session).add(CALIBRATE, wish.site_id, survey_id, options.to_json())
    log.info("a calibration is asked for", extra={"job_id": job.job_id, "survey_id": survey_id})
    return job


def _check_count(count: int) -> None:
    if not FEWEST_PHOTOS <= count <= MOST_PHOTOS:
        raise InvalidInput(
            f"{count} photographs are there and a calibration takes {FEWEST_PHOTOS} to {MOST_PHOTOS}: 5 to 20 of the "
            "site's targets, near and far in one picture, all over it, every third with the phone turned by a quarter",
            field="images",
        )


def _version(site: Site) -> int:
    """The map that photographs are oriented in."""
    if site.active_version is None:
        raise Conflict(
            "the site has no target map yet, and a camera is calibrated against one; survey the site first, which "
            "calibrates the survey's camera too",
            site_id=site.site_id,
        )
    return site.active_version
