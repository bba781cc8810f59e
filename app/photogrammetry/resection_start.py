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
from app.photogrammetry.kernels.votes import find_middles, measure_misses
from app.photogrammetry.planar_pose import PlanarPoseOptions, planar_poses
from app.photogrammetry.resection_input import SightedTargets

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Index = npt.NDArray[np.intp]


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
    proposers: Index
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


def find_start(sighted: SightedTargets, camera: Camera, options: StartOptions | None = None) -> Start | None:
    """Proposals and votes; None when no target has enough dots for a planar pose."""
    options = options or StartOptions()
    count = len(sighted)
    middles_m, middles_px, sizes_px2 = np.empty((count, 3)), np.empty((count, 2)), np.empty(count)
    seen = (sighted.centres_m, sighted.arms_m, sighted.observed_px, sighted.measured)
    find_middles(seen, (middles_m, middles_px, sizes_px2))
    # A target's pose is the better, the further its dots lie from their middle in the image.
    proposers = np.argsort(-sizes_px2, kind="stable")[: options.proposers]
    points_px = np.concatenate([middles_px, sighted.observed_px[proposers].reshape(-1, 2)])
    normalised = np.empty_like(points_px)
    normalise_points(camera.intrinsics.copy(), points_px, UNDISTORT_STEPS, normalised)
    dots = normalised[count:].reshape(len(proposers), -1, 2)
    proposals, owners = _propose(sighted, proposers, dots, options)
    if not owners.size:
        return None
    misses = np.empty((len(owners), count))
    measure_misses((middles_m, sighted.rotations, normalised[:count]), proposals, misses)
    return Start(*proposals, owners, misses, options.vote_limit)


def _propose(
    sighted: SightedTargets, proposers: Index, normalised: Array, options: StartOptions
) -> tuple[tuple[Array, Array], Index]:
    """Both planar poses of some targets, where they exist: H rotations and positions in the site, and their owners."""
    site_from_target = sighted.rotations[proposers]
    plane_m = (sighted.arms_m[proposers] @ site_from_target)[..., :2]
    found = planar_poses(plane_m, normalised, sighted.measured[proposers], options.planar)
    exists = found.exists
    rotations = site_from_target[:, None] @ np.swapaxes(found.rotations, -1, -2)
    positions_m = sighted.centres_m[proposers][:, None] - (rotations @ found.translations_m[..., None])[..., 0]
    return (rotations[exists], positions_m[exists]), np.repeat(proposers, exists.sum(axis=1))
