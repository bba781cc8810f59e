"""Poses against the truth: root mean square errors and normalised errors squared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.cli.score import Rmse, rmse_of
from app.geometry.pose import Pose
from app.geometry.rotation import angle_between_deg, log_rotation

Array = npt.NDArray[np.float64]

POSE_DOF = 6


@dataclass(frozen=True)
class EstimatedPose:
    """A photograph's pose with its covariance, shape (6, 6): position (m), small rotation (rad), site axes."""

    name: str
    site_from_cam: Pose
    covariance: Array


@dataclass(frozen=True)
class PoseScore:
    """Poses of several photographs.

    Attributes
    ----------
    count : int
    rmse : Rmse
        Of the positions.
    worst_m : float
        Greatest distance from the truth.
    angle_rmse_deg : float
    nees_mean : float
        6 expected; photographs of one survey share its datum, so their mean scatters more than independent ones would.
    sigma_rms_m : float
        Root mean square of the claimed 3-D standard deviations.
    """

    count: int
    rmse: Rmse
    worst_m: float
    angle_rmse_deg: float
    nees_mean: float
    sigma_rms_m: float


def score_poses(poses: Sequence[EstimatedPose], truth: dict[str, Pose]) -> PoseScore | None:
    """Score photographs by name; None when there is none."""
    if not poses:
        return None
    errors_m = np.array([pose.site_from_cam.position_m - truth[pose.name].position_m for pose in poses])
    angles_deg = [angle_between_deg(pose.site_from_cam.rotation, truth[pose.name].rotation) for pose in poses]
    variances_m2 = [np.trace(pose.covariance[:3, :3]) for pose in poses]
    return PoseScore(
        count=len(poses),
        rmse=rmse_of(errors_m),
        worst_m=float(np.linalg.norm(errors_m, axis=1).max()),
        angle_rmse_deg=float(np.sqrt(np.square(angles_deg).mean())),
        nees_mean=float(np.mean([_nees(pose, truth[pose.name]) for pose in poses])),
        sigma_rms_m=float(np.sqrt(np.mean(variances_m2))),
    )


def _nees(estimated: EstimatedPose, true_site_from_cam: Pose) -> float:
    pose = estimated.site_from_cam
    moved_m = true_site_from_cam.position_m - pose.position_m
    turned_rad = log_rotation(true_site_from_cam.rotation @ pose.rotation.T)
    error = np.concatenate([moved_m, turned_rad])
    return float(error @ np.linalg.solve(estimated.covariance, error))
