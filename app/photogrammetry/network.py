"""A network: where the photographs and targets of a survey stand, with the cameras and the print scales.

It is the state of the adjustment, in one frame: ``model`` for the free network, ``site`` once control has fixed it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_COUNT
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.geometry.similarity import Similarity
from app.photogrammetry.prints import PRINT_COUNT
from app.targets.layout import dot_centres_u

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]

POSE_COUNT = 6  # unknowns of a pose: position (m), small rotation (rad)


@dataclass(frozen=True)
class NetworkStep:
    """Small changes of a network: photographs (P, 6), targets (T, 6), intrinsics (C, 9), print scales (T, 2)."""

    photos: Array
    targets: Array
    intrinsics: Array
    print_scale: Array


@dataclass(frozen=True)
class Network:
    """Poses of P photographs and T targets in one frame, C cameras, the targets' print scales.

    Attributes
    ----------
    photo_rotations, photo_positions_m : ndarray of shape (P, 3, 3), (P, 3)
        ``frame_from_cam``; positions are projection centres.
    target_rotations, target_positions_m : ndarray of shape (T, 3, 3), (T, 3)
        ``frame_from_target``.
    intrinsics : ndarray of shape (C, 9)
        Of each camera, OpenCV's order.
    print_scale : ndarray of shape (T, 2)
        Printed length over nominal length of each target, along the plate's x and y.
    """

    photo_rotations: Array
    photo_positions_m: Array
    target_rotations: Array
    target_positions_m: Array
    intrinsics: Array
    print_scale: Array

    def __post_init__(self) -> None:
        if self.photo_rotations.shape != (len(self.photo_positions_m), 3, 3):
            raise ValueError("each photograph needs a rotation and a position")
        if self.target_rotations.shape != (len(self.target_positions_m), 3, 3):
            raise ValueError("each target needs a rotation and a position")
        if self.intrinsics.shape[1:] != (INTRINSIC_COUNT,):
            raise ValueError("a network needs nine intrinsics per camera")
        if self.print_scale.shape != (len(self.target_positions_m), PRINT_COUNT):
            raise ValueError("each target needs two print scales")

    def moved(self, step: NetworkStep) -> Network:
        """The network after a small step; rotations act from the left, in the frame's axes."""
        return Network(
            exp_rotation(step.photos[:, 3:]) @ self.photo_rotations,
            self.photo_positions_m + step.photos[:, :3],
            exp_rotation(step.targets[:, 3:]) @ self.target_rotations,
            self.target_positions_m + step.targets[:, :3],
            self.intrinsics + step.intrinsics,
            self.print_scale + step.print_scale,
        )

    def among(self, photos: Index, targets: Index) -> Network:
        """The same network with some of its photographs and targets, renumbered by their place in the lists."""
        return replace(
            self,
            photo_rotations=self.photo_rotations[photos],
            photo_positions_m=self.photo_positions_m[photos],
            target_rotations=self.target_rotations[targets],
            target_positions_m=self.target_positions_m[targets],
            print_scale=self.print_scale[targets],
        )

    def with_part(self, part: Network, photos: Index, targets: Index) -> Network:
        """The network with the poses of ``part`` (numbered as by ``among``) and its cameras put in."""
        replaced = {
            "photo_rotations": (photos, part.photo_rotations),
            "photo_positions_m": (photos, part.photo_positions_m),
            "target_rotations": (targets, part.target_rotations),
            "target_positions_m": (targets, part.target_positions_m),
            "print_scale": (targets, part.print_scale),
        }
        arrays = {name: getattr(self, name).copy() for name in replaced}
        for name, (index, values) in replaced.items():
            arrays[name][index] = values
        return replace(self, intrinsics=part.intrinsics, **arrays)

    def transformed(self, target_from_source: Similarity) -> Network:
        """The network in another frame; the plates' size changes with its scale."""
        rotation = target_from_source.rotation
        return Network(
            rotation @ self.photo_rotations,
            target_from_source.apply(self.photo_positions_m),
            rotation @ self.target_rotations,
            target_from_source.apply(self.target_positions_m),
            self.intrinsics,
            self.print_scale * target_from_source.scale,
        )

    def photo_pose(self, photo: int) -> Pose:
        """``frame_from_cam`` of one photograph."""
        return Pose(_proper(self.photo_rotations[photo]), self.photo_positions_m[photo])

    def target_pose(self, target: int) -> Pose:
        """``frame_from_target`` of one target."""
        return Pose(_proper(self.target_rotations[target]), self.target_positions_m[target])

    def dots_m(self, u_m: float) -> Array:
        """All dots in the frame, shape (T, 16, 3), print scale included."""
        plane_m = dot_centres_u() * u_m * self.print_scale[:, None]
        return plane_m @ np.swapaxes(self.target_rotations[..., :2], -1, -2) + self.target_positions_m[:, None]


def _proper(rotation: Array) -> Array:
    """The nearest rotation matrix: many small steps leave rounding behind."""
    u, _, vt = np.linalg.svd(rotation)
    return np.asarray(u @ vt)
