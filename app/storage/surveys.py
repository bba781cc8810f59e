"""Surveys, their photographs and what detectors saw in them."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from app.errors import Conflict, NotFound
from app.geometry.camera import CameraIdentity
from app.geometry.observations import Detection
from app.storage.blobs import blob_of_detection, detection_of_blob
from app.storage.ids import new_id
from app.storage.models import DetectionRow, PhotographRow, SurveyRow
from app.storage.paging import Page, PageRequest, page_of
from app.storage.records import StoredPhoto, Survey
from app.storage.sites import find_site_row
from app.storage.upsert import insert_if_absent

KEYS_PER_QUERY = 500  # SQLite takes 999 parameters in its oldest builds


@dataclass(frozen=True)
class DetectionKey:
    """What a stored detection depends on."""

    sha256: str
    detector: str
    options_digest: str


class SurveyRepository:
    """Surveys of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, site_id: str, note: str, device_id: str | None) -> Survey:
        """A new survey, open for photographs.

        Raises
        ------
        NotFound
            When there is no such site.
        """
        find_site_row(self._session, site_id)
        row = SurveyRow(id=new_id(), site_id=site_id, note=note, device_id=device_id, created_s=time.time())
        self._session.add(row)
        self._session.flush()
        return _survey(row)

    def get(self, survey_id: str) -> Survey:
        """One survey.

        Raises
        ------
        NotFound
        """
        row = self._session.get(SurveyRow, survey_id)
        if row is None:
            raise NotFound(
                f"there is no survey {survey_id}; POST /sites/{{site_id}}/surveys opens one", survey_id=survey_id
            )
        return _survey(row)

    def page(self, site_id: str, request: PageRequest) -> Page[Survey]:
        """The surveys of a site in the order they were opened."""
        find_site_row(self._session, site_id)
        query = select(SurveyRow).where(SurveyRow.site_id == site_id).order_by(SurveyRow.id).limit(request.limit + 1)
        if request.after is not None:
            query = query.where(SurveyRow.id > request.after)
        return page_of([(row.id, _survey(row)) for row in self._session.scalars(query)], request.limit)

    def add_photo(self, survey_id: str, photo: StoredPhoto) -> bool:
        """Add a photograph; False when the same bytes are there already under this name.

        Raises
        ------
        Conflict
            When other bytes are there under this name.
        """
        if insert_if_absent(self._session, PhotographRow, **_photo_values(survey_id, photo)):
            return True
        self.has_photo(survey_id, photo)
        return False

    def has_photo(self, survey_id: str, photo: StoredPhoto) -> bool:
        """Whether the same bytes, as they were sent, are there already under this name.

        Raises
        ------
        Conflict
            When other bytes are there under this name.
        """
        query = select(PhotographRow.sent_sha256).where(
            PhotographRow.survey_id == survey_id, PhotographRow.name == photo.name
        )
        present_sha256 = self._session.scalars(query).one_or_none()
        if present_sha256 not in (None, photo.sent_sha256):
            raise Conflict(
                f"the survey already has another photograph named {photo.name}; upload this one under another name",
                filename=photo.name,
                sha256=present_sha256,
            )
        return present_sha256 is not None

    def photo_page(self, survey_id: str, request: PageRequest) -> Page[StoredPhoto]:
        """Photographs of a survey by name."""
        self.get(survey_id)
        query = select(PhotographRow).where(PhotographRow.survey_id == survey_id).order_by(PhotographRow.name)
        if request.after is not None:
            query = query.where(PhotographRow.name > request.after)
        rows = self._session.scalars(query.limit(request.limit + 1))
        return page_of([(row.name, _photo(row)) for row in rows], request.limit)

    def photos(self, survey_id: str) -> tuple[StoredPhoto, ...]:
        """All photographs of a survey by name."""
        query = select(PhotographRow).where(PhotographRow.survey_id == survey_id).order_by(PhotographRow.name)
        return tuple(_photo(row) for row in self._session.scalars(query))

    def photo(self, survey_id: str, name: str) -> StoredPhoto:
        """One photograph of a survey.

        Raises
        ------
        NotFound
        """
        self.get(survey_id)
        query = select(PhotographRow).where(PhotographRow.survey_id == survey_id, PhotographRow.name == name)
        row = self._session.scalars(query).one_or_none()
        if row is None:
            raise NotFound(
                f"the survey has no photograph {name}; GET /surveys/{survey_id}/images lists them", filename=name
            )
        return _photo(row)

    def photo_count(self, survey_id: str) -> int:
        """How many photographs a survey has."""
        query = select(func.count()).select_from(PhotographRow).where(PhotographRow.survey_id == survey_id)
        return self._session.scalar(query) or 0


class DetectionRepository:
    """Detections of one session: a cache by photograph, detector and options."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def put(self, key: DetectionKey, detection: Detection) -> None:
        """Keep a detection; a repeat changes nothing."""
        insert_if_absent(
            self._session,
            DetectionRow,
            sha256=key.sha256,
            detector=key.detector,
            options_digest=key.options_digest,
            record=blob_of_detection(detection),
            created_s=time.time(),
        )

    def get(self, key: DetectionKey) -> Detection | None:
        """A kept detection, None when there is none."""
        row = self._session.get(DetectionRow, (key.sha256, key.detector, key.options_digest))
        return None if row is None else detection_of_blob(row.record)

    def missing(self, keys: Iterable[DetectionKey]) -> tuple[DetectionKey, ...]:
        """Those of the keys that nothing is kept for, each once."""
        unique = tuple(dict.fromkeys(keys))
        columns = DetectionRow.sha256, DetectionRow.detector, DetectionRow.options_digest
        present: set[DetectionKey] = set()
        for start in range(0, len(unique), KEYS_PER_QUERY):
            digests = [key.sha256 for key in unique[start : start + KEYS_PER_QUERY]]
            rows = self._session.execute(select(*columns).where(DetectionRow.sha256.in_(digests)))
            present.update(DetectionKey(*row) for row in rows)
        return tuple(key for key in unique if key not in present)


def _survey(row: SurveyRow) -> Survey:
    return Survey(row.id, row.site_id, row.note, row.device_id, row.created_s)


def _photo_values(survey_id: str, photo: StoredPhoto) -> dict[str, Any]:
    return {
        "id": new_id(),
        "survey_id": survey_id,
        "name": photo.name,
        "sha256": photo.sha256,
        "size_bytes": photo.size_bytes,
        "sent_sha256": photo.sent_sha256,
        "sent_bytes": photo.sent_bytes,
        "identity": asdict(photo.identity),
        "captured_at": photo.captured_at,
        "created_s": photo.created_s,
    }


def _photo(row: PhotographRow) -> StoredPhoto:
    return StoredPhoto(
        name=row.name,
        sha256=row.sha256,
        size_bytes=row.size_bytes,
        sent_sha256=row.sent_sha256,
        sent_bytes=row.sent_bytes,
        identity=CameraIdentity(**row.identity),
        captured_at=row.captured_at,
        created_s=row.created_s,
    )
