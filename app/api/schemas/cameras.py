"""Cameras, and the form that asks for a calibration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from fastapi import Form
from pydantic import BaseModel, Field

from app.api.dependencies import Id
from app.api.schemas.common import Listing, numbers_of, time_of
from app.api.schemas.texts import Text
from app.geometry.camera import INTRINSIC_NAMES
from app.services.calibration_request import CalibrationWish
from app.storage.paging import Page
from app.storage.records import StoredCamera

FIRST_DISTORTION = 4  # of the nine intrinsics
GREATEST_READOUT_S = 1.0


@dataclass(frozen=True)
class CalibrationForm:
    """What a form says of a calibration beside its photographs."""

    site_id: str
    survey_id: str | None
    device_id: str | None
    readout_s: float | None

    @classmethod
    def of_form(
        cls,
        site_id: Annotated[Id, Form(min_length=1, description="Whose active map the photographs show.")],
        survey_id: Annotated[
            Id | None, Form(description="Of the site, that holds the photographs; then none are sent along.")
        ] = None,
        device_id: Annotated[Text | None, Form(description="Whose camera it is.")] = None,
        readout_s: Annotated[
            float | None,
            Form(ge=0, le=GREATEST_READOUT_S, allow_inf_nan=False, description="Of the sensor's rows, where known."),
        ] = None,
    ) -> CalibrationForm:
        """The form's fields."""
        return cls(site_id, survey_id, device_id, readout_s)

    def to_domain(self) -> CalibrationWish:
        """The calibration as services know it."""
        return CalibrationWish(self.site_id, self.survey_id, self.device_id, self.readout_s)


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
    sigmas: dict[str, float] = Field(
        description="Standard deviations of fx ... k3, with the scatter between photographs."
    )
    readout_s: float | None = Field(description="Of the sensor's rows, where it is known.")
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
            readout_s=None if camera.calibrated.readout is None else camera.calibrated.readout.duration_s,
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
