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

Array = npt.NDArray[np.float64]

SCATTERED_COUNT = 3  # log focal length, cx, cy
FEWEST_PHOTOS = 3  # a scatter takes more than two values


@dataclass(frozen=True)
class CameraScatter:
    """Standard deviations between photographs: focal length (relative), principal point (px)."""

    focal: float
    centre_px: Array

    def deviations(self, camera: Camera) -> Array:
        """One standard deviation of focal length, cx and cy, as intrinsics, shape (9, 3)."""
        return _scattered(camera) * np.array([self.focal, *self.centre_px])

    def covariance(self, camera: Camera) -> Array:
        """How far a photograph's intrinsics are off the camera's, shape (9, 9)."""
        deviations = self.deviations(camera)
        return np.asarray(deviations @ deviations.T)


@dataclass(frozen=True)
class SelfCalibration:
    """One camera of the survey.

    Attributes
    ----------
    calibrated : CalibratedCamera
        Covariance: posterior plus scatter.
    of_network : ndarray of shape (9, 9)
        What the adjustment says: the intrinsics' covariance if all photographs had the very same camera.
    posterior : ndarray of shape (9, 9)
        The same with what the photographs' scatter leaves in what they were adjusted to.
    scatter : CameraScatter
    photographs : int
        That took part.
    """

    calibrated: CalibratedCamera
    of_network: Array
    posterior: Array
    scatter: CameraScatter
    photographs: int


def self_calibrate(
    problem: BundleProblem,
    network: Network,
    border_covariance: Array,
    target_covariances: Array | None = None,
    doubt: float = 0.0,
) -> tuple[SelfCalibration, ...]:
    """All cameras of an adjusted network.

    Parameters
    ----------
    problem : BundleProblem
    network : Network
        Adjusted.
    border_covariance : ndarray of shape (f, f)
        Of the shared unknowns, nine rows per camera first.
    target_covariances : ndarray of shape (T, 6, 6), optional
        Of the adjusted targets, where they are not far better known than one photograph could tell.
    doubt : float
        Standard deviations of the scatter's own estimate that are added to it: a few photographs hide a scatter as
        great as what each of them tells.
    """
    shares = _photo_shares(problem, network, target_covariances)
    found = []
    for camera in range(len(problem.cameras)):
        of_camera = problem.camera_of_photo == camera
        columns = problem.camera_columns(camera)
        adjusted = problem.camera_at(network, camera)
        scatter = _scatter_of(shares.select(of_camera), adjusted, doubt)
        of_network = border_covariance[columns, columns]
        posterior = of_network + _passed_on(shares.select(of_camera), of_network, scatter.covariance(adjusted))
        calibrated = _calibrated(adjusted, posterior, scatter)
        found.append(SelfCalibration(calibrated, of_network, posterior, scatter, int(of_camera.sum())))
    return tuple(found)


def _calibrated(adjusted: Camera, posterior: Array, scatter: CameraScatter) -> CalibratedCamera:
    covariance = posterior + scatter.covariance(adjusted)
    return CalibratedCamera(adjusted, (covariance + covariance.T) / 2.0, "survey")


@dataclass(frozen=True)
class _PhotoShares:
    """What each of P photographs by itself says of the intrinsics, its pose eliminated.

    Attributes
    ----------
    information : ndarray of shape (P, 9, 9)
    gradient : ndarray of shape (P, 9)
    """

    information: Array
    gradient: Array

    def select(self, chosen: npt.NDArray[np.bool_]) -> _PhotoShares:
        """Some of the photographs."""
        return _PhotoShares(self.information[chosen], self.gradient[chosen])


def _photo_shares(problem: BundleProblem, network: Network, target_covariances: Array | None) -> _PhotoShares:
    """Normal equations of each photograph; targets held, or free within their covariances."""
    loss, count = BundleOptions().loss, POSE_COUNT + INTRINSIC_COUNT
    normals = np.zeros((problem.sightings.photo_count, count + 1, count + 1))
    for camera, chunk in problem.chunks():
        part = problem.sightings.select(chunk)
        equations = linearise(network, part, problem.camera_at(network, camera), problem.plane_m)
        by_target = equations.jacobian[..., :POSE_COUNT]
        by_pose = by_target @ equations.target_step_from_photo_step[:, None]
        columns = [by_pose, equations.jacobian[..., CAMERA_COLUMNS], equations.residuals[..., None], by_target]
        root_weight = np.sqrt(loss.weight((equations.residuals**2).sum(axis=-1)))[..., None, None]
        rows = (np.concatenate(columns, axis=-1) * root_weight).reshape(len(part), -1, count + 1 + POSE_COUNT)
        products = np.swapaxes(rows, -1, -2) @ rows
        own, wanted = products[:, count + 1 :, count + 1 :], products[:, : count + 1, : count + 1]
        if target_covariances is not None:
            across = products[:, count + 1 :, : count + 1]
            freed = own + np.linalg.inv(target_covariances[part.target])
            wanted = wanted - np.swapaxes(across, -1, -2) @ np.linalg.solve(freed, across)
        np.add.at(normals, part.photo, wanted)
    pose = np.linalg.pinv(normals[:, :POSE_COUNT, :POSE_COUNT], hermitian=True)
    across = normals[:, POSE_COUNT:, :POSE_COUNT]
    reduced = normals[:, POSE_COUNT:, POSE_COUNT:] - across @ pose @ np.swapaxes(across, -1, -2)
    return _PhotoShares(reduced[:, :INTRINSIC_COUNT, :INTRINSIC_COUNT], reduced[:, :INTRINSIC_COUNT, -1])


def _scatter_of(shares: _PhotoShares, adjusted: Camera, doubt: float) -> CameraScatter:
    """Scatter between a camera's photographs.

    Notes
    -----
    Each photograph estimates its own focal length and principal point beside its pose. Their variance beyond what
    noise gives is the method of moments of DerSimonian and Laird, Controlled Clinical Trials 7, 1986, eq. 8.
    """
    directions = _scattered(adjusted)
    information = directions.T @ shares.information @ directions
    inverse = np.linalg.pinv(information, hermitian=True)
    offsets = -(inverse @ (shares.gradient @ directions)[..., None])[..., 0]
    sigma = np.sqrt(_excess_variance(offsets, np.diagonal(inverse, axis1=1, axis2=2), doubt))
    return CameraScatter(float(sigma[0]), sigma[1:])


def _passed_on(shares: _PhotoShares, of_network: Array, scatter: Array) -> Array:
    """Covariance, shape (9, 9), that a scatter of (9, 9) between photographs leaves in what they were adjusted to.

    A photograph whose intrinsics are off by d pulls the adjusted ones by ``of_network @ its information @ d``.
    """
    pulls = of_network @ shares.information
    return np.asarray((pulls @ scatter @ np.swapaxes(pulls, -1, -2)).sum(axis=0))


def _scattered(adjusted: Camera) -> Array:
    """Derivative of the intrinsics by log focal length, cx and cy, shape (9, 3)."""
    directions = np.zeros((INTRINSIC_COUNT, SCATTERED_COUNT))
    directions[:2, 0] = adjusted.intrinsics[:2]
    directions[2, 1] = directions[3, 2] = 1.0
    return directions


def _excess_variance(offsets: Array, variances: Array, doubt: float) -> Array:
    """Variance of offsets (n, 3) beyond their own variances, shape (3,), never negative."""
    if len(offsets) < FEWEST_PHOTOS:
        return np.zeros(SCATTERED_COUNT)
    weights = 1.0 / variances
    mean = (weights * offsets).sum(axis=0) / weights.sum(axis=0)
    statistic = (weights * (offsets - mean) ** 2).sum(axis=0)
    capacity = weights.sum(axis=0) - (weights**2).sum(axis=0) / weights.sum(axis=0)
    freedom = len(offsets) - 1
    # The statistic of offsets that do not scatter is chi-square distributed: its variance is twice its freedom.
    return np.maximum(0.0, (statistic - freedom) / capacity) + doubt * np.sqrt(2.0 * freedom) / capacity
