"""Planar poses of sightings and how well poses agree with what photographs saw: the votes a network grows by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_normals import squared_residuals
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.growth import Growth
from app.photogrammetry.network import Network
from app.photogrammetry.planar_pose import planar_poses
from app.photogrammetry.sightings import Sightings
from app.targets.layout import BASE_CELLS

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

CORNER_CELLS = np.array(BASE_CELLS[:4])  # four dots fix a plane's image; votes need no more

# What a pose costs that puts a target behind the camera, as a multiple of the focal length: more than any image.
BEHIND = 10.0

HOPELESS = 10.0  # tolerances; how far beyond them a misfit lies says nothing more about a pose


@dataclass(frozen=True)
class SightedPoses:
    """Both planar poses of some sightings, and their dots in the image plane.

    Attributes
    ----------
    sightings : Sightings
    normalised : ndarray of shape (m, 16, 2)
    rotations, positions_m : ndarray of shape (m, 2, 3, 3), (m, 2, 3)
        ``cam_from_target``, the better first.
    exists : ndarray of shape (m, 2), bool
    """

    sightings: Sightings
    normalised: Array
    rotations: Array
    positions_m: Array
    exists: Mask

    def select(self, rows: Mask | slice) -> SightedPoses:
        """Some of the sightings."""
        return SightedPoses(
            self.sightings.select(rows),
            self.normalised[rows],
            self.rotations[rows],
            self.positions_m[rows],
            self.exists[rows],
        )


def normalised_dots(problem: BundleProblem, network: Network, sightings: Sightings) -> Array:
    """Undistorted image-plane coordinates of sightings with the network's cameras, shape (m, 16, 2)."""
    camera = problem.camera_of_photo[sightings.photo]
    normalised = np.empty(sightings.dots_px.shape)
    for index in np.unique(camera):
        normalised[camera == index] = problem.camera_at(network, index).normalise(sightings.dots_px[camera == index])
    return normalised


def sighted_poses(problem: BundleProblem, network: Network, sightings: Sightings) -> SightedPoses:
    """Planar poses of sightings, with the network's present cameras and print scale."""
    normalised = normalised_dots(problem, network, sightings)
    poses = planar_poses(
        problem.plane_m * network.print_scale[sightings.target][:, None], normalised, sightings.measured
    )
    return SightedPoses(sightings, normalised, poses.rotations, poses.translations_m, poses.exists)


def image_size(sightings: Sightings) -> Array:
    """Size of each sighted target, shape (m,), px: the longer diagonal of its base dots."""
    corners_px = sightings.dots_px[:, CORNER_CELLS]
    return np.asarray(np.linalg.norm(corners_px[:, :2] - corners_px[:, 2:], axis=-1).max(axis=-1))


def misfit(cam_m: Array, normalised: Array) -> Array:
    """Root mean square distance of dots' images, shape (...), as a fraction of the focal length.

    Parameters
    ----------
    cam_m : ndarray of shape (..., n, 3)
        Dots in the camera frame.
    normalised : ndarray of shape (..., n, 2)
        Where they were seen, image plane.
    """
    behind = np.asarray((cam_m[..., 2] <= 0).any(axis=-1))
    depth_m = np.where(behind[..., None], 1.0, cam_m[..., 2])
    off = cam_m[..., :2] / depth_m[..., None] - normalised
    return np.where(behind, BEHIND, np.minimum(np.sqrt((off**2).sum(axis=-1).mean(axis=-1)), BEHIND))


def votes(misfits: Array, tolerance: float) -> Array:
    """Cost of misfits: their square in units of the tolerance while small, flat when large: a false code is false."""
    return np.asarray(np.log1p(np.minimum(misfits / tolerance, HOPELESS) ** 2))


def turn_rad(first: Array, second: Array) -> Array:
    """Angles between rotation matrices of shapes (..., 3, 3), rad."""
    cosine = ((first * second).sum(axis=(-1, -2)) - 1.0) / 2.0  # trace of first' second
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def rms_in_tolerances(growth: Growth, problem: BundleProblem, network: Network) -> Array:
    """Root mean square residual of each sighting, shape (M,), as a multiple of what still speaks for a pose."""
    mean = squared_residuals(problem, network).sum(axis=-1) / problem.sightings.measured.sum(axis=-1)
    return np.asarray(np.sqrt(mean) / growth.capture_loss.width)
