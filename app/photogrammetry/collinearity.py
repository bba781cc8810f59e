"""Collinearity equations of whole sightings: whitened residuals and their derivatives, many targets at once.

A photograph's small step moves a target's image as a small step of the target the other way would. So each sighting
is differentiated by its target, the print scale and the camera only, 17 unknowns, and the six columns of the
photograph follow from the target's by one 6 x 6 matrix per sighting (``target_step_from_photo_step``).
Source: Sensors 2019 (robust visual encoded targets), eq. 7 and 8.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_COUNT, Camera
from app.geometry.rotation import skew
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.prints import PRINT_COUNT
from app.photogrammetry.sightings import Sightings
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]

PRINT_COLUMNS = slice(POSE_COUNT, POSE_COUNT + PRINT_COUNT)
CAMERA_COLUMNS = slice(POSE_COUNT + PRINT_COUNT, POSE_COUNT + PRINT_COUNT + INTRINSIC_COUNT)
COLUMN_COUNT = POSE_COUNT + PRINT_COUNT + INTRINSIC_COUNT

# A dot nearer than this to the camera's plane has no image. It keeps the (large) residual it would have here and no
# derivative, so that a step that puts a target behind a camera is refused and a false sighting pulls at nothing.
NEAREST_M = 0.01


@dataclass(frozen=True)
class Linearised:
    """Whitened collinearity equations of M sightings.

    Attributes
    ----------
    rows : ndarray of shape (M, 16, 2, 18)
        Derivatives by the target (position m, small rotation rad, frame axes), the print scale (x, y) and the nine
        intrinsics; last the residual, computed minus observed. In standard deviations; zero where not measured.
    target_step_from_photo_step : ndarray of shape (M, 6, 6)
        Times the target's columns: the derivative by the photograph (position, small rotation, frame axes).
    """

    rows: Array
    target_step_from_photo_step: Array

    @property
    def jacobian(self) -> Array:
        """Derivatives alone, shape (M, 16, 2, 17)."""
        return self.rows[..., :COLUMN_COUNT]

    @property
    def residuals(self) -> Array:
        """Residuals alone, shape (M, 16, 2)."""
        return self.rows[..., COLUMN_COUNT]


def whitened_residuals(network: Network, sightings: Sightings, camera: Camera, plane_m: Array) -> Array:
    """Computed minus observed dots, shape (M, 16, 2), in standard deviations.

    Parameters
    ----------
    network : Network
    sightings : Sightings
        All of one camera.
    camera : Camera
    plane_m : ndarray of shape (16, 2)
        Nominal dots in the target's plane.
    """
    _, _, cam_m = _dots_in_camera(network, sightings, plane_m)
    return sightings.whiten((camera.project(_in_front(cam_m)) - sightings.dots_px)[..., None])[..., 0]


def linearise(network: Network, sightings: Sightings, camera: Camera, plane_m: Array) -> Linearised:
    """Residuals as of ``whitened_residuals`` with their derivatives."""
    arms_m, offsets_m, cam_m = _dots_in_camera(network, sightings, plane_m)
    computed_px, by_cam, by_intrinsics = camera.project_with_jacobians(_in_front(cam_m))
    shape, flat = (len(sightings), DOT_COUNT, 2, -1), (len(sightings), 2 * DOT_COUNT, 3)
    plate_axes = network.target_rotations[sightings.target][..., :PRINT_COUNT]
    cam_from_frame = np.swapaxes(network.photo_rotations[sightings.photo], -1, -2)
    by_point = by_cam.reshape(flat) @ cam_from_frame
    rows_px = np.empty((len(sightings), DOT_COUNT, 2, COLUMN_COUNT + 1))
    rows_px[..., :3] = by_point.reshape(shape)
    # a . (dtheta x arm) = dtheta . (arm x a)
    rows_px[..., 3:POSE_COUNT] = np.cross(arms_m[:, :, None], rows_px[..., :3])
    rows_px[..., PRINT_COLUMNS] = (by_point @ plate_axes).reshape(shape) * plane_m[:, None]
    rows_px[..., CAMERA_COLUMNS] = by_intrinsics
    rows_px[..., :COLUMN_COUNT] *= (cam_m[..., 2] > NEAREST_M)[..., None, None]
    rows_px[..., COLUMN_COUNT] = computed_px - sightings.dots_px
    return Linearised(sightings.whiten(rows_px), target_step_from_photo_step(offsets_m))


def _dots_in_camera(network: Network, sightings: Sightings, plane_m: Array) -> tuple[Array, Array, Array]:
    """Dots from their target's centre, shape (M, 16, 3), frame axes; targets' centres from the projection centre,
    shape (M, 3), frame axes; dots in the camera frame, shape (M, 16, 3).
    """
    plate_axes = network.target_rotations[sightings.target][..., :PRINT_COUNT]
    arms_m = (plane_m * network.print_scale[sightings.target][:, None]) @ np.swapaxes(plate_axes, -1, -2)
    offsets_m = network.target_positions_m[sightings.target] - network.photo_positions_m[sightings.photo]
    return arms_m, offsets_m, (arms_m + offsets_m[:, None]) @ network.photo_rotations[sightings.photo]


def _in_front(cam_m: Array) -> Array:
    depth_m = np.maximum(cam_m[..., 2:], NEAREST_M)
    return np.concatenate([cam_m[..., :2], depth_m], axis=-1)


def target_step_from_photo_step(offsets_m: Array) -> Array:
    """Matrices, shape (M, 6, 6), for targets' centres at offsets (M, 3) from projection centres, frame axes.

    Moving a camera by dC and turning it by dtheta is moving a target by offset x dtheta - dC and turning it back.
    """
    steps = np.zeros((len(offsets_m), POSE_COUNT, POSE_COUNT))
    steps[:, :3, :3] = steps[:, 3:, 3:] = -np.eye(3)
    steps[:, :3, 3:] = skew(offsets_m)
    return steps
