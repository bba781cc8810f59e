"""A first pose of the camera: every large target proposes its two planar poses, and all targets vote.

The sample is a target, not a dot: a target is right or wrong as a whole (moved, misread), and one is enough for a pose.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.geometry.camera import UNDISTORT_STEPS, Camera
from app.geometry.kernels.undistortion import normalise_points
from app.geometry.pose import Pose
from app.photogrammetry.planar_pose import PlanarPoseOptions, planar_poses
from app.photogrammetry.resection_input import SightedTargets

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class StartOptions:
    """How the first pose is found.

    Attributes
    ----------
    proposers : int
        Targets that propose, the largest in the image first. All six must be wrong for the start to fail.
    vote_limit : float
        How far, in normalised image units (about rad), a target may stand from where a pose predicts it and still count
        as agreeing. Poses of one small plate are good to a few degrees; misread codes are off by tens.
    planar : PlanarPoseOptions
        Unrefined planar poses are good enough to vote on.
    """

    proposers: int = 6
    vote_limit: float = 0.1
    planar: PlanarPoseOptions = PlanarPoseOptions(refinement_steps=0)


@dataclass(frozen=True)
class Start:
    """Proposed poses and who agrees with them.

    Attributes
    ----------
    rotations : ndarray of shape (H, 3, 3)
        ``site_from_cam`` of each proposal.
    positions_m : ndarray of shape (H, 3)
    proposers : ndarray of shape (H,), int
        The target that made each proposal; the largest targets make two each.
    misses : ndarray of shape (H, K)
        How far each target stands from where each proposal sees it, normalised image units; infinite where the target
        would stand behind the camera or show it its back.
    vote_limit : float
        Up to which a target agrees.
    """

    rotations: Array
    positions_m: Array
    proposers: npt.NDArray[np.intp]
    misses: Array
    vote_limit: float

    @cached_property
    def elected(self) -> int:
        """The proposal that most targets agree with."""
        return int(np.argmin((np.minimum(self.misses / self.vote_limit, 1.0) ** 2).sum(axis=1)))

    def pose(self, proposal: int) -> Pose:
        """``site_from_cam`` of a proposal."""
        return Pose(self.rotations[proposal], self.positions_m[proposal])

    def agreeing(self, proposal: int) -> Mask:
        """Targets that stand about where a proposal sees them, shape (K,)."""
        return np.asarray(self.misses[proposal] < self.vote_limit)

    def between(self, proposer: int, other: int) -> int:
        """Of one target's proposals the one that sees another target best."""
        own = np.flatnonzero(self.proposers == proposer)
        return int(own[np.argmin(self.misses[own, other])])


@dataclass(frozen=True)
class _Middles:
    """Middles of the measured dots: site frame (K, 3), plates' normals (K, 3), normalised image (K, 2)."""

    middles_m: Array
    normals: Array
    normalised: Array


def find_start(sighted: SightedTargets, camera: Camera, options: StartOptions | None = None) -> Start | None:
    """Proposals and votes; None when no target has enough dots for a planar pose."""
    options = options or StartOptions()
    proposers = _largest(sighted, options)
    weights = sighted.measured / np.maximum(sighted.dot_counts, 1)[:, None]
    middles_px = (weights[:, None] @ sighted.observed_px)[:, 0]
    dots_px = sighted.observed_px[proposers].reshape(-1, 2)
    points_px = np.concatenate([middles_px, dots_px])
    normalised = np.empty_like(points_px)
    normalise_points(np.array(camera.intrinsics), points_px, UNDISTORT_STEPS, normalised)
    middles, dots = normalised[: len(sighted)], normalised[len(sighted) :].reshape(len(proposers), -1, 2)
    rotations, positions_m, exists = _propose(sighted.take(proposers), dots, options)
    if not exists.any():
        return None
    middles_m = sighted.centres_m + (weights[:, None] @ sighted.arms_m)[:, 0]
    seen = _Middles(middles_m, sighted.rotations[..., 2], middles)
    rotations, positions_m = rotations[exists], positions_m[exists]
    owners = np.broadcast_to(proposers[:, None], exists.shape)[exists]
    return Start(rotations, positions_m, owners, _misses(seen, rotations, positions_m), options.vote_limit)


def _largest(sighted: SightedTargets, options: StartOptions) -> npt.NDArray[np.intp]:
    """Indices of the targets with the largest sum of squared distances between image and centroid: the best posed."""
    weights = sighted.measured[..., None]
    counts = np.maximum(sighted.dot_counts, 1)[:, None, None]
    centred_px = sighted.observed_px - (sighted.observed_px * weights).sum(axis=1, keepdims=True) / counts
    size_px2 = (centred_px**2 * weights).sum(axis=(1, 2))
    return np.argsort(-size_px2, kind="stable")[: options.proposers]


def _propose(sighted: SightedTargets, normalised: Array, options: StartOptions) -> tuple[Array, Array, Mask]:
    """Both planar poses of P targets in the site: rotations (P, 2, 3, 3), positions (P, 2, 3), which exist (P, 2)."""
    plane_m = (sighted.arms_m @ sighted.rotations)[..., :2]
    found = planar_poses(plane_m, normalised, sighted.measured, options.planar)
    rotations = sighted.rotations[:, None] @ np.swapaxes(found.rotations, -1, -2)
    positions_m = sighted.centres_m[:, None] - (rotations @ found.translations_m[..., None])[..., 0]
    return rotations, positions_m, found.exists


def _misses(seen: _Middles, rotations: Array, positions_m: Array) -> Array:
    """How far each target's middle stands from where each proposal sees it, normalised units, shape (H, K)."""
    offsets_m = seen.middles_m - positions_m[:, None]
    cam_m = offsets_m @ rotations
    from_front = (cam_m[..., 2] > 0) & ((offsets_m * seen.normals).sum(axis=-1) < 0)
    depth_m = np.where(from_front, cam_m[..., 2], 1.0)
    misses = np.linalg.norm(cam_m[..., :2] / depth_m[..., None] - seen.normalised, axis=-1)
    return np.where(from_front, misses, np.inf)
