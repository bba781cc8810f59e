"""Target maps and their versions."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, Field

from app.api.schemas.common import Listing, Quaternion, Vector3, time_of
from app.storage.paging import Page
from app.storage.records import MapVersion
from app.targets.layout import DOT_COUNT


class TargetAnswer(BaseModel):
    """A target of a map."""

    code: int
    position_m: Vector3
    orientation_xyzw: Quaternion
    dots_m: Annotated[list[Vector3], Field(min_length=DOT_COUNT, max_length=DOT_COUNT, description="Row-major cells.")]
    sigma_m: Annotated[Vector3, Field(description="Of the position in the site frame, the datum's part included.")]
    rays: int
    rms_px: float
    covariance: list[list[float]] = Field(
        description="6 x 6, the target's own part: position (m, site axes), small rotation (rad, site axes)."
    )


class DatumAnswer(BaseModel):
    """The uncertainty that all targets share."""

    origin_m: Vector3
    covariance: list[list[float]] = Field(description="7 x 7: translation (m), rotation (rad), log-scale.")
    assumed_scale: bool = Field(description="True when no control fixed the scale: it comes from the printed pitch.")
    assumed_orientation: bool = Field(description="True when no control fixed the axes: z comes from the plates.")


class TargetsAnswer(BaseModel):
    """A version of a site's target map; saved to a file it is a map for ``scattermark locate``."""

    site_id: str
    map_version: int
    format: str
    code_family: str
    plate_u_m: float
    targets: list[TargetAnswer]
    datum: DatumAnswer
    cameras: list[dict[str, Any]] = Field(
        description="Calibrated with it: identity, intrinsics, covariance, source."
    )


class MapAnswer(BaseModel):
    """A version of a site's map without its targets."""

    map_version: int
    survey_id: str | None
    base_version: int | None
    targets: int
    active: bool
    created_at: str

    @classmethod
    def of(cls, version: MapVersion) -> MapAnswer:
        """The answer for a version."""
        return cls(
            map_version=version.version,
            survey_id=version.survey_id,
            base_version=version.base_version,
            targets=version.target_count,
            active=version.active,
            created_at=time_of(version.created_s),
        )


class MapsAnswer(Listing):
    """A page of versions."""

    maps: list[MapAnswer]

    @classmethod
    def of(cls, page: Page[MapVersion]) -> MapsAnswer:
        """The answer for a page."""
        return cls(maps=[MapAnswer.of(version) for version in page.items], next_cursor=page.next_cursor)
