"""Target maps, their versions, cameras."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, Field

from app.api.schemas.common import Listing, Quaternion, Vector3, numbers_of, time_of
from app.geometry.camera import INTRINSIC_NAMES
from app.storage.paging import Page
from app.storage.records import MapVersion, StoredCamera
from app.targets.layout import DOT_COUNT

FIRST_DISTORTION = 4  # of the nine intrinsics


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
    cameras: list[dict[str, Any]] = Field(description="The survey's cameras: identity, intrinsics, covariance, source.")


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


class CameraAnswer(BaseModel):
    """A calibrated camera."""

    camera_id: str
    make: str
    model: str
    width_px: int
    height_px: int
    fx: float
    fy: float
    cx: float
    cy: float
    dist: list[float] = Field(description="k1, k2, p1, p2, k3 (OpenCV)")
    sigmas: dict[str, float] = Field(description="Standard deviations of fx ... k3.")
    source: str
    device_id: str | None
    site_id: str | None
    map_version: int | None
    created_at: str

    @classmethod
    def of(cls, camera: StoredCamera) -> CameraAnswer:
        """The answer for a camera."""
        intrinsics = camera.calibrated.camera.intrinsics
        sigmas = np.sqrt(np.diag(camera.calibrated.covariance))
        focal: dict[str, Any] = dict(
            zip(("fx", "fy", "cx", "cy"), numbers_of(intrinsics[:FIRST_DISTORTION]), strict=True)
        )
        return cls(
            camera_id=camera.camera_id,
            make=camera.identity.make,
            model=camera.identity.model,
            width_px=camera.identity.width_px,
            height_px=camera.identity.height_px,
            **focal,
            dist=numbers_of(intrinsics[FIRST_DISTORTION:]),
            sigmas=dict(zip(INTRINSIC_NAMES, numbers_of(sigmas), strict=True)),
            source=camera.calibrated.source,
            device_id=camera.device_id,
            site_id=camera.site_id,
            map_version=camera.map_version,
            created_at=time_of(camera.created_s),
        )


class CamerasAnswer(Listing):
    """A page of cameras."""

    cameras: list[CameraAnswer]

    @classmethod
    def of(cls, page: Page[StoredCamera]) -> CamerasAnswer:
        """The answer for a page."""
        return cls(cameras=[CameraAnswer.of(camera) for camera in page.items], next_cursor=page.next_cursor)
