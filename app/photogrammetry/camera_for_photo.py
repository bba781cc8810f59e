"""One camera at another image size: scaled when the picture is the same, turned when it was stored on its side."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated
from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera, Camera

Array = npt.NDArray[np.float64]

QUARTER_TURNS = (1, 3)  # clockwise: a picture on its side was turned to the one or to the other side


@dataclass(frozen=True)
class CameraForPhotoOptions:
    """When two image sizes show the same picture.

    Attributes
    ----------
    aspect_tolerance : float
        Greatest relative difference of the aspect ratios. Encoders round sizes to multiples of 16 px, 1 % of 1600.
    """

    aspect_tolerance: float = 0.01


def cameras_for_photo(
    calibrated: CalibratedCamera, width_px: int, height_px: int, options: CameraForPhotoOptions | None = None
) -> tuple[CalibratedCamera, ...]:
    """The camera at a photograph's size: one when the aspect ratio agrees, both quarter turns when it is transposed.

    Raises
    ------
    NotLocated
        Reason ``unknown-camera`` when the photograph is another cut of the sensor: nothing is known of it.
    """
    options = options or CameraForPhotoOptions()
    camera = calibrated.camera
    wanted, known = width_px / height_px, camera.width_px / camera.height_px
    if abs(wanted / known - 1.0) <= options.aspect_tolerance:
        return (scaled(calibrated, width_px, height_px),)
    if abs(wanted * known - 1.0) <= options.aspect_tolerance:
        upright = scaled(calibrated, height_px, width_px)
        return tuple(turned(upright, quarter_turns) for quarter_turns in QUARTER_TURNS)
    advice = "send intrinsics for this image size, or calibrate the camera at it"
    raise NotLocated(
        f"The camera is known at {camera.width_px} x {camera.height_px} px and the photograph has {width_px} x "
        f"{height_px} px, which is another cut of its sensor: {advice}.",
        reason="unknown-camera",
        advice=advice,
        seen={"width_px": width_px, "height_px": height_px},
    )


def scaled(calibrated: CalibratedCamera, width_px: int, height_px: int) -> CalibratedCamera:
    """The same picture at another size; distortion belongs to the image plane and stays."""
    camera = calibrated.camera
    if (width_px, height_px) == (camera.width_px, camera.height_px):
        return calibrated
    scale_x, scale_y = width_px / camera.width_px, height_px / camera.height_px
    factors = np.array([scale_x, scale_y, scale_x, scale_y, 1.0, 1.0, 1.0, 1.0, 1.0])
    intrinsics = camera.intrinsics * factors
    # Pixel centres stand at integers, so the picture's corner is (-1/2, -1/2) at every size.
    intrinsics[2:4] += (factors[2:4] - 1.0) / 2.0
    covariance = calibrated.covariance * np.outer(factors, factors)
    return replace(calibrated, camera=Camera(width_px, height_px, intrinsics), covariance=covariance)


def turned(calibrated: CalibratedCamera, quarter_turns: int) -> CalibratedCamera:
    """The same picture turned clockwise by one or three quarter turns, covariance included."""
    camera = calibrated.camera
    turned_camera = camera.turned(quarter_turns)
    # Turning permutes the intrinsics, flips signs and shifts: unit steps give its derivative exactly.
    columns = [
        camera.with_intrinsics(camera.intrinsics + step).turned(quarter_turns).intrinsics - turned_camera.intrinsics
        for step in np.eye(INTRINSIC_COUNT)
    ]
    derivative = np.column_stack(columns)
    covariance = derivative @ calibrated.covariance @ derivative.T
    readout = None if calibrated.readout is None else calibrated.readout.turned(quarter_turns)
    return replace(calibrated, camera=turned_camera, covariance=covariance, readout=readout)
