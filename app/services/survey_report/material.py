"""All that a survey's report tells: the adjustment, the map that came of it, the photographs, what they belong to."""

from __future__ import annotations

from dataclasses import dataclass

from app.geometry.target_map import TargetMap
from app.photogrammetry.report import AdjustmentReport
from app.services.build_options import Exclusion
from app.storage.records import PhotoResult


@dataclass(frozen=True)
class Fingerprint:
    """A digest that ties a signed report to the numbers it stands for: of what, and the SHA-256 in hexadecimal."""

    of: str
    sha256: str


@dataclass(frozen=True)
class Heading:
    """What a report belongs to.

    Attributes
    ----------
    site_name : str
    site_id, survey_id : str or None
        None for a map that was built without the service.
    map_version : int or None
    survey_note : str
    built_s, written_s : float
        When the map was built and the report written, UTC.
    software : str
    fingerprint : Fingerprint
    """

    site_name: str
    site_id: str | None
    survey_id: str | None
    map_version: int | None
    survey_note: str
    built_s: float
    written_s: float
    software: str
    fingerprint: Fingerprint


@dataclass(frozen=True)
class Extended:
    """How a map came of another one: its version, codes that were added and codes found in another place."""

    base_version: int
    added: tuple[int, ...]
    moved: tuple[int, ...]


@dataclass(frozen=True)
class ReportMaterial:
    """What a report is written from.

    Attributes
    ----------
    heading : Heading
    report : AdjustmentReport
    target_map : TargetMap
        As published: of an extended map it holds more than the survey saw.
    photos : tuple of PhotoResult
        All that the build was given, those without a pose included.
    excluded : Exclusion
        What the surveyor left out.
    extended : Extended or None
    """

    heading: Heading
    report: AdjustmentReport
    target_map: TargetMap
    photos: tuple[PhotoResult, ...]
    excluded: Exclusion = Exclusion()
    extended: Extended | None = None

    @property
    def unoriented(self) -> tuple[PhotoResult, ...]:
        """Photographs without a pose."""
        return tuple(photo for photo in self.photos if photo.site_from_cam is None)
