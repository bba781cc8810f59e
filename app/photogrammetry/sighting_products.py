"""What each sighting of an adjusted network says by itself, before the others answer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.collinearity import CAMERA_COLUMNS, COLUMN_COUNT, linearise
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.robust import RobustLoss
from app.photogrammetry.self_calibration import SCATTERED_COUNT, CameraScatter

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


@dataclass(frozen=True)
class SightingProducts:
    """Of M sightings, each dot with its robust weight.

    Attributes
    ----------
    by_columns : ndarray of shape (M, 6, 18)
        The target's columns times all columns and the residuals.
    turned : ndarray of shape (M, 6, 6)
        The target's step that shows as a photograph's step.
    lens : ndarray of shape (M, 6, 3)
        Change of the pull by one standard deviation of the photograph's focal length and principal point, which its
        pose follows.
    """

    by_columns: Array
    turned: Array
    lens: Array

    @property
    def information(self) -> Array:
        """On the target's step, shape (M, 6, 6)."""
        return self.by_columns[..., :POSE_COUNT]

    @property
    def pulls(self) -> Array:
        """Shape (M, 6)."""
        return self.by_columns[..., COLUMN_COUNT]


def sighting_products(
    problem: BundleProblem, network: Network, loss: RobustLoss, scatters: Sequence[CameraScatter]
) -> SightingProducts:
    """Products of all sightings of an adjusted network; ``scatters`` are those of its cameras."""
    count = len(problem.sightings)
    by_columns = np.empty((count, POSE_COUNT, COLUMN_COUNT + 1))
    turned, lens = np.empty((count, POSE_COUNT, POSE_COUNT)), np.empty((count, POSE_COUNT, SCATTERED_COUNT))
    for camera, chunk in problem.chunks():
        part, adjusted = problem.sightings.select(chunk), problem.camera_at(network, camera)
        equations = linearise(network, part, adjusted, problem.plane_m)
        weight = loss.weight((equations.residuals**2).sum(axis=-1))
        rows = (equations.rows * np.sqrt(weight)[..., None, None]).reshape(len(part), -1, COLUMN_COUNT + 1)
        by_columns[chunk] = np.swapaxes(rows[..., :POSE_COUNT], -1, -2) @ rows
        turned[chunk] = equations.target_step_from_photo_step
        lens[chunk] = by_columns[chunk][..., CAMERA_COLUMNS] @ scatters[camera].deviations(adjusted)
    return SightingProducts(by_columns, turned, _after_pose(problem.sightings.photo, by_columns, turned, lens))


def _after_pose(photo: Index, by_columns: Array, turned: Array, lens: Array) -> Array:
    """What is left of changes of the pulls, shape (M, 6, 3), when each photograph's pose has followed them."""
    count = int(photo.max()) + 1
    pose, across = np.zeros((count, POSE_COUNT, POSE_COUNT)), np.zeros((count, POSE_COUNT, SCATTERED_COUNT))
    by_photo = by_columns[..., :POSE_COUNT] @ turned
    np.add.at(pose, photo, np.swapaxes(turned, -1, -2) @ by_photo)
    np.add.at(across, photo, np.swapaxes(turned, -1, -2) @ lens)
    return np.asarray(lens - by_photo @ (np.linalg.pinv(pose, hermitian=True) @ across)[photo])
