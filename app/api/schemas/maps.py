"""Target maps and their versions."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, Field

from app.api.schemas.common import Listing, Quaternion, Vector3, time_of
from app.geometry.camera import Camera
from app.services.maps import MappedPhoto
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
    cameras: list[dict[str, Any]] = Field(description="Calibrated with it: identity, intrinsics, covariance, source.")


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


class FrameAnswer(BaseModel):
    """What of a camera says where it looks: size of its pictures, focal lengths and principal point, px."""

    width_px: int
    height_px: int
    fx: float
    fy: float
    cx: float
    cy: float

    @classmethod
    def of(cls, camera: Camera) -> FrameAnswer:
        """The answer for a camera."""
        fx, fy, cx, cy = camera.intrinsics[:4].tolist()
        return cls(width_px=camera.width_px, height_px=camera.height_px, fx=fx, fy=fy, cx=cx, cy=cy)


class MapPhotoAnswer(BaseModel):
    """What became of a photograph in a map's adjustment: its pose in the site frame, or why it has none."""

    name: str
    camera: FrameAnswer | None = Field(description="As the survey calibrated it; null without a pose.")
    position_m: Vector3 | None
    orientation_xyzw: Quaternion | None
    position_sigma_m: Annotated[Vector3 | None, Field(description="The datum's part included.")]
    rms_px: float | None
    codes: list[int] | None = Field(
        description="Of the targets that took part; null without a pose, and for maps of earlier releases."
    )
    reason: str | None = Field(description="Why the photograph has no pose.")

    @classmethod
    def of(cls, photo: MappedPhoto) -> MapPhotoAnswer:
        """The answer for a photograph."""
        result, pose = photo.result, photo.result.site_from_cam
        return cls(
            name=result.name,
            camera=None if photo.camera is None else FrameAnswer.of(photo.camera),
            position_m=None if pose is None else pose.position_m.tolist(),
            orientation_xyzw=None if pose is None else pose.orientation_xyzw.tolist(),
            position_sigma_m=None if result.covariance is None else np.sqrt(np.diag(result.covariance)[:3]).tolist(),
            rms_px=result.rms_px,
            codes=None if result.codes is None else list(result.codes),
            reason=result.reason,
        )


class MapPhotosAnswer(Listing):
    """A page of the photographs of a map version."""

    photos: list[MapPhotoAnswer]

    @classmethod
    def of(cls, page: Page[MappedPhoto]) -> MapPhotosAnswer:
        """The answer for a page."""
        return cls(photos=[MapPhotoAnswer.of(photo) for photo in page.items], next_cursor=page.next_cursor)
