"""A camera as a JSON file: what ``scattermark calibrate`` writes, or intrinsics that a user knows."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from app.errors import InvalidInput
from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera, Camera
from app.geometry.readout import Readout
from app.photogrammetry.camera_prior import camera_from_client

DISTORTION_COUNT = 5


def read_camera(path: Path) -> CalibratedCamera:
    """The camera of a file.

    Raises
    ------
    InvalidInput
        When it is missing, no JSON, or no camera.
    """
    try:
        return _camera(json.loads(path.read_text()))
    except OSError as error:
        raise InvalidInput(f"cannot read the camera {path}: {error.strerror}") from error
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InvalidInput(
            f"{path} describes no camera ({error!r}); give JSON with width_px, height_px, fx, fy, cx, cy and "
            "dist (k1, k2, p1, p2, k3), and covariance (9 x 9) and readout_s where they are known"
        ) from error


def _camera(record: Mapping[str, Any]) -> CalibratedCamera:
    distortion = record.get("dist") or [0.0] * DISTORTION_COUNT
    values = [record["fx"], record["fy"], record["cx"], record["cy"], *distortion]
    camera = Camera(int(record["width_px"]), int(record["height_px"]), np.array(values, dtype=np.float64))
    readout_s = record.get("readout_s")
    readout = None if readout_s is None else Readout(float(readout_s))
    if record.get("covariance") is None:
        known = camera_from_client(camera, distortion_known="dist" in record)
        return CalibratedCamera(camera, known.covariance, known.source, readout)
    covariance = np.array(record["covariance"], dtype=np.float64).reshape(INTRINSIC_COUNT, INTRINSIC_COUNT)
    return CalibratedCamera(camera, covariance, "calibration", readout)
