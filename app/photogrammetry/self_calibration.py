"""What a survey knows of its cameras: the adjustment's posterior, and how far a photograph's own camera may be off it.

Autofocus and stabilised lenses move the focal length and the principal point from photograph to photograph. A snapshot
takes the survey's camera as its prior, so the scatter that the survey shows belongs to the prior's covariance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera, Camera
from app.photogrammetry.bundle import BundleOptions
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.collinearity import CAMERA_COLUMNS, linearise
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.robust import RobustLoss

Array = npt.NDArray[np.float64]

SCATTERED_COUNT = 3  # log focal length, cx, cy
FEWEST_PHOTOS = 3  # a scatter takes more than two values


@dataclass(frozen=True)
class CameraScatter:
    """Standard deviations between photographs: focal length (relative), principal point (px)."""

    focal: float
    centre_px: Array


@dataclass(frozen=True)
class SelfCalibration:
    """One camera of the survey.

    Attributes
    ----------
    calibrated : CalibratedCamera
        Covariance: posterior plus scatter.
    posterior : ndarray of shape (9, 9)
        Of the intrinsics that the adjustment found.
    scatter : CameraScatter
    photographs : int
        That took part.
    """

    calibrated: CalibratedCamera
    posterior: Array
    scatter: CameraScatter
    photographs: int


def self_calibrate(problem: BundleProblem, network: Network, border_covariance: Array) -> tuple[SelfCalibration, ...]:
    """All cameras of an adjusted network; border covariance of shape (f, f), nine rows per camera first."""
    found = []
    for camera, scatter in enumerate(camera_scatter(problem, network, BundleOptions().loss)):
        columns = problem.camera_columns(camera)
        posterior = border_covariance[columns, columns]
        calibrated = _calibrated(problem.camera_at(network, camera), posterior, scatter)
        found.append(SelfCalibration(calibrated, posterior, scatter, int((problem.camera_of_photo == camera).sum())))
    return tuple(found)


def _calibrated(adjusted: Camera, posterior: Array, scatter: CameraScatter) -> CalibratedCamera:
    focal_px = np.zeros(INTRINSIC_COUNT)
    focal_px[:2] = scatter.focal * adjusted.intrinsics[:2]
    covariance = posterior + np.outer(focal_px, focal_px)
    covariance[[2, 3], [2, 3]] += scatter.centre_px**2
    return CalibratedCamera(adjusted, (covariance + covariance.T) / 2.0, "survey")


def camera_scatter(problem: BundleProblem, network: Network, loss: RobustLoss) -> tuple[CameraScatter, ...]:
    """Scatter of each camera between its photographs, targets held; zero with fewer than three photographs.

    Notes
    -----
    Each photograph estimates its own focal length and principal point beside its pose. Their variance beyond what
    noise gives is the method of moments of DerSimonian and Laird, Controlled Clinical Trials 7, 1986, eq. 8.
    """
    offsets, variances = _own_estimates(problem, network, loss)
    found = []
    for camera in range(len(problem.cameras)):
        of_camera = problem.camera_of_photo == camera
        sigma = np.sqrt(_excess_variance(offsets[of_camera], variances[of_camera]))
        found.append(CameraScatter(float(sigma[0]), sigma[1:]))
    return tuple(found)


def _own_estimates(problem: BundleProblem, network: Network, loss: RobustLoss) -> tuple[Array, Array]:
    """What each photograph would add to the three values, and the variances of that, shapes (P, 3)."""
    count = POSE_COUNT + SCATTERED_COUNT
    normals = np.zeros((problem.sightings.photo_count, count + 1, count + 1))
    for camera, chunk in problem.chunks():
        part = problem.sightings.select(chunk)
        equations = linearise(network, part, problem.camera_at(network, camera), problem.plane_m)
        by_camera = equations.jacobian[..., CAMERA_COLUMNS]
        by_pose = equations.jacobian[..., :POSE_COUNT] @ equations.target_step_from_photo_step[:, None]
        by_log_focal = by_camera[..., :2] @ network.intrinsics[camera, :2]
        rows = np.concatenate(
            [by_pose, by_log_focal[..., None], by_camera[..., 2:4], equations.residuals[..., None]], axis=-1
        )
        weight = loss.weight((equations.residuals**2).sum(axis=-1))
        rows = (rows * np.sqrt(weight)[..., None, None]).reshape(len(part), -1, count + 1)
        np.add.at(normals, part.photo, np.swapaxes(rows, -1, -2) @ rows)
    inverse = np.linalg.pinv(normals[:, :count, :count], hermitian=True)
    offsets = -(inverse @ normals[:, :count, count:])[:, POSE_COUNT:, 0]
    return offsets, np.diagonal(inverse, axis1=1, axis2=2)[:, POSE_COUNT:]


def _excess_variance(offsets: Array, variances: Array) -> Array:
    """Variance of offsets (n, 3) beyond their own variances, shape (3,), never negative."""
    if len(offsets) < FEWEST_PHOTOS:
        return np.zeros(SCATTERED_COUNT)
    weights = 1.0 / variances
    mean = (weights * offsets).sum(axis=0) / weights.sum(axis=0)
    statistic = (weights * (offsets - mean) ** 2).sum(axis=0)
    capacity = weights.sum(axis=0) - (weights**2).sum(axis=0) / weights.sum(axis=0)
    return np.maximum(0.0, (statistic - (len(offsets) - 1)) / capacity)
