"""Located snapshots against the truth: an error per snapshot, and the root mean squares that the paper reports.

Errors are estimate - truth. Source of the two-dimensional figure: Sensors 2019, table 4 (dx, dy, dd).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.geometry.rotation import angle_between_deg

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Located:
    """A snapshot's answer.

    Attributes
    ----------
    name : str
    site_from_cam : Pose or None
        None when it was refused.
    sigma_m : ndarray of shape (3,) or None
        Standard deviations of the position.
    reason : str or None
        Why it was refused.
    """

    name: str
    site_from_cam: Pose | None = None
    sigma_m: Array | None = None
    reason: str | None = None


@dataclass(frozen=True)
class SnapshotScore:
    """One row of the accuracy table; metres and degrees, None where there is no pose."""

    name: str
    error_m: Array | None
    angle_deg: float | None
    sigma_m: Array | None
    reason: str | None


@dataclass(frozen=True)
class Rmse:
    """Root mean square errors of the positions, metres.

    Attributes
    ----------
    x_m, y_m, z_m : float
        Per axis of the site frame.
    xy_m : float
        Of the distance in the plane: the paper's dd.
    xyz_m : float
        Of the distance in space.
    """

    x_m: float
    y_m: float
    z_m: float
    xy_m: float
    xyz_m: float


def score_snapshot(located: Located, true_site_from_cam: Pose) -> SnapshotScore:
    """Error of one snapshot."""
    pose = located.site_from_cam
    if pose is None:
        return SnapshotScore(located.name, None, None, None, located.reason or "refused")
    error_m = pose.position_m - true_site_from_cam.position_m
    angle_deg = angle_between_deg(pose.rotation, true_site_from_cam.rotation)
    return SnapshotScore(located.name, error_m, angle_deg, located.sigma_m, None)


def rmse_of(errors_m: Array) -> Rmse:
    """Root mean squares of position errors of shape (N, 3), N >= 1."""
    square = np.square(errors_m).mean(axis=0)
    x_m, y_m, z_m = np.sqrt(square)
    return Rmse(float(x_m), float(y_m), float(z_m), float(np.sqrt(square[:2].sum())), float(np.sqrt(square.sum())))


def rmse_of_scores(scores: list[SnapshotScore]) -> Rmse | None:
    """Root mean squares over the located snapshots; None when there is none."""
    errors_m = [score.error_m for score in scores if score.error_m is not None]
    return rmse_of(np.array(errors_m)) if errors_m else None


def score_to_json(score: SnapshotScore) -> dict[str, Any]:
    """A JSON-ready row."""
    return {
        "name": score.name,
        "error_m": None if score.error_m is None else score.error_m.tolist(),
        "distance_m": None if score.error_m is None else float(np.linalg.norm(score.error_m)),
        "angle_deg": score.angle_deg,
        "sigma_m": None if score.sigma_m is None else score.sigma_m.tolist(),
        "reason": score.reason,
    }
