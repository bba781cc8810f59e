"""The truth about synthetic photographs and targets, as JSON in the form of ``examples/room``."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from app.geometry.camera import Camera
from app.geometry.control import ControlPoint
from app.planning.imaging import ImagingOptions
from app.planning.plan_path import Stop
from app.planning.scene import PostedTarget
from app.planning.sight import SeenTarget
from app.trajectories.trajectory import Trajectory

# Micrometres and a thousandth of a pixel: far below anything that is measured.
METRES_DIGITS, PIXEL_DIGITS, ROTATION_DIGITS, SIZE_DIGITS, ANGLE_DIGITS = 6, 3, 9, 3, 2
CONTROL_COLUMNS = ("name", "code", "dot", "x_m", "y_m", "z_m", "sigma_m", "role")


def camera_record(camera: Camera, imaging: ImagingOptions) -> dict[str, Any]:
    """What is true of the camera: OpenCV's model, px."""
    fx, fy, cx, cy, *distortion = camera.intrinsics.tolist()
    names = {"make": imaging.make, "model": imaging.model, "w": camera.width_px, "h": camera.height_px}
    return {**names, "fx": fx, "fy": fy, "cx": cx, "cy": cy, "dist": distortion}


def shot_record(stop: Stop, seen: Sequence[SeenTarget]) -> dict[str, Any]:
    """What is true of one photograph; ``visible`` lists the plates of which all sixteen dots are seen wholly."""
    return {
        "file": stop.name,
        "time_s": round(stop.time_s, METRES_DIGITS),
        "position_m": _rounded(stop.site_from_cam.position_m, METRES_DIGITS),
        "world_from_cam": _rounded(stop.site_from_cam.rotation, ROTATION_DIGITS),
        "visible": [_plate_record(target) for target in seen if target.whole],
    }


def targets_record(targets: Iterable[PostedTarget], u_m: float) -> dict[str, Any]:
    """Where each target's dots are, in the site frame; plates of wrong structure are none."""
    posted = [
        {"code": target.code, "dots_m": _rounded(target.dots_m(), METRES_DIGITS)}
        for target in targets
        if not target.wrong
    ]
    return {"u_m": u_m, "targets": posted}


def control_csv(points: Iterable[ControlPoint]) -> str:
    """Control and check points as ``scattermark build --control`` reads them; to a hundredth of a millimetre."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(CONTROL_COLUMNS)
    for point in points:
        coordinates = [f"{value:.5f}" for value in point.position_m]
        writer.writerow([point.name, point.code, point.dot, *coordinates, f"{point.sigma_m:g}", point.role])
    return text.getvalue()


def walk_truth(stops: Iterable[Stop]) -> Trajectory:
    """The poses of a walk's photographs."""
    walked = [stop for stop in stops if stop.walk_s is not None]
    return Trajectory(
        np.array([stop.time_s for stop in walked]),
        np.stack([stop.site_from_cam.position_m for stop in walked]),
        np.stack([stop.site_from_cam.orientation_xyzw for stop in walked]),
    )


def _plate_record(target: SeenTarget) -> dict[str, Any]:
    return {
        "code": target.code,
        "wrong": target.wrong,
        "px_per_u": round(target.px_per_u, SIZE_DIGITS),
        "incidence_deg": round(target.incidence_deg, ANGLE_DIGITS),
        "dots_px": _rounded(target.dots_px, PIXEL_DIGITS),
    }


def _rounded(values: npt.NDArray[np.float64], digits: int) -> Any:
    return np.round(values, digits).tolist()
