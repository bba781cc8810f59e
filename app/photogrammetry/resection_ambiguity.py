"""The other pose: a small plane, tilted to the other side of the line of sight, looks nearly the same.

Whatever the number of targets, the adjusted scene is mirrored about the line of sight and adjusted again. Mostly it
comes back to the same pose; when it stays elsewhere, the likelihoods of the two decide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.geometry.rotation import log_rotation
from app.photogrammetry.kernels.mirror import see_alike, sum_moments
from app.photogrammetry.resection_adjustment import AdjustedState
from app.photogrammetry.resection_consensus import Problem
from app.photogrammetry.resection_equations import State

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class AmbiguityOptions:
    """When two poses cannot be told apart.

    Attributes
    ----------
    min_odds : float
        Least odds of the better pose against the other, 1,000 to 1.
    same_sigmas : float
        Poses closer than this many standard deviations are one pose, whose covariance speaks for both.
    hopeless : float
        Factor of the logarithm of ``min_odds`` beyond which no calibration of the camera could save the other pose.
    mirror_limit : float
        Greatest root mean square shift of the dots by mirroring, normalised image units, for which that of several
        targets is adjusted at all: 0.005 is 7 px at a focal length of 1400 px, a hundred sigmas of a dot.
    """

    min_odds: float = 1000.0
    same_sigmas: float = 1.0
    hopeless: float = 10.0
    mirror_limit: float = 0.005


@dataclass(frozen=True)
class Ambiguity:
    """A pose beside its mirror image.

    Attributes
    ----------
    adjusted : AdjustedState
        The better of the two.
    other : AdjustedState or None
        The other; None when both starts lead to one pose.
    """

    adjusted: AdjustedState
    other: AdjustedState | None

    @property
    def ratio(self) -> float | None:
        """Root mean square residual (in sigmas) of the other pose over that of the better; None without another."""
        if self.other is None:
            return None
        floor = np.finfo(np.float64).eps * self.other.chi2
        return float(np.sqrt(self.other.attainable_chi2 / max(self.adjusted.chi2, floor)))

    @property
    def log_odds(self) -> float:
        """Logarithm of the odds of the better pose against the other; infinite without another.

        Half the difference of the chi-squares, scaled by the variance factor when residuals exceed their sigmas.
        """
        if self.other is None:
            return float("inf")
        variance_factor = max(1.0, self.adjusted.chi2 / max(self.adjusted.redundancy, 1))
        return (self.other.attainable_chi2 - self.adjusted.chi2) / (2.0 * variance_factor)

    def is_open(self, options: AmbiguityOptions) -> bool:
        """Whether the other pose is too likely to be passed over."""
        return self.log_odds < np.log(options.min_odds)


def better_side(problem: Problem, targets: Mask, start: State, options: AmbiguityOptions | None = None) -> State:
    """Adjust the pose alone, and its mirror image; the state that fits better."""
    first = problem.adjust(targets, start, free_camera=False)
    mirrored = _mirrored(problem, targets, first.state, options or AmbiguityOptions())
    if mirrored is None:
        return first.state
    second = problem.adjust(targets, mirrored, free_camera=False)
    return first.state if first.chi2 <= second.chi2 else second.state


def look_for_mirror(
    problem: Problem, targets: Mask, adjusted: AdjustedState, options: AmbiguityOptions | None = None
) -> Ambiguity:
    """Adjust the mirror image too, the camera with it, and say which of the two fits better."""
    options = options or AmbiguityOptions()
    mirrored = _mirrored(problem, targets, adjusted.state, options)
    if mirrored is None:
        return Ambiguity(adjusted, None)
    other = problem.adjust(targets, mirrored, free_camera=False)
    ambiguity = Ambiguity(adjusted, other)
    if ambiguity.log_odds > options.hopeless * np.log(options.min_odds):
        return ambiguity
    other = problem.adjust(targets, other.state)
    better, worse = (adjusted, other) if adjusted.chi2 <= other.chi2 else (other, adjusted)
    if not worse.equations.seen_from_front.all() or _distance_sigmas(better, worse) < options.same_sigmas:
        return Ambiguity(better, None)
    return Ambiguity(better, worse)


def _mirrored(problem: Problem, targets: Mask, state: State, options: AmbiguityOptions) -> State | None:
    """The mirror image to start from; None when perspective rules it out at sight."""
    sighted, pose = problem.sighted, state.site_from_cam
    dots = (sighted.centres_m, sighted.arms_m, sighted.measured)
    middle_m, moments_m2 = np.empty(3), np.empty((3, 3))
    count = sum_moments(dots, targets, middle_m, moments_m2)
    _, axes = np.linalg.eigh(moments_m2)
    mirrored = mirrored_pose(pose, middle_m, axes[:, 0])
    alone = np.count_nonzero(targets) == 1
    if not alone and not see_alike(dots, targets, (pose.arrays, mirrored.arrays), count * options.mirror_limit**2):
        return None
    return State(mirrored, state.whitened)


def mirrored_pose(site_from_cam: Pose, middle_m: Array, normal: Array) -> Pose:
    """The pose that sees a plane tilted to the other side of the line of sight.

    The scene turns about its middle by twice the angle between the plane's normal and the line of sight, which is a
    reflection in the plane and one across the line.

    Parameters
    ----------
    site_from_cam : Pose
    middle_m, normal : ndarray of shape (3,)
        Of the plane, site axes; either of its two normals.
    """
    offset_m = middle_m - site_from_cam.position_m
    in_plane, across_sight = _reflection(normal), _reflection(offset_m / np.linalg.norm(offset_m))
    return Pose(in_plane @ across_sight @ site_from_cam.rotation, middle_m + in_plane @ offset_m)


def _reflection(axis: Array) -> Array:
    """The matrix, shape (3, 3), that turns a unit vector round and leaves what is perpendicular to it."""
    return np.eye(3) - 2.0 * np.outer(axis, axis)


def _distance_sigmas(first: AdjustedState, second: AdjustedState) -> float:
    """How far apart two states are, in standard deviations of the first."""
    one, other = first.state, second.state
    difference = np.concatenate(
        [
            other.site_from_cam.position_m - one.site_from_cam.position_m,
            log_rotation(other.site_from_cam.rotation @ one.site_from_cam.rotation.T),
            other.whitened - one.whitened,
        ]
    )
    return float(np.sqrt(difference @ first.information @ difference))
