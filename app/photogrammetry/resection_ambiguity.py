"""The other pose: a small plane, tilted to the other side of the line of sight, looks nearly the same.

Whatever the number of targets, the adjusted scene is mirrored about the line of sight and adjusted again. Mostly it
comes back to the same pose; when it stays elsewhere, the likelihoods of the two decide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation, log_rotation
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
        Greatest mean shift of the dots by mirroring, normalised image units, for which the mirror image of several
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
    dots_m = problem.sighted.dots_m[targets][problem.sighted.measured[targets]]
    mirrored = mirrored_pose(state.site_from_cam, dots_m)
    alone = np.count_nonzero(targets) == 1
    if not alone and _shift(state.site_from_cam, mirrored, dots_m) > options.mirror_limit:
        return None
    return State(mirrored, state.whitened)


def mirrored_pose(site_from_cam: Pose, dots_m: Array) -> Pose:
    """The pose that sees the dots' plane tilted to the other side of the line of sight.

    The scene turns about its middle by twice the angle between the plane's normal and the line of sight.
    """
    cam_from_site = site_from_cam.rotation.T
    middle_m = dots_m.mean(axis=0)
    _, axes = np.linalg.eigh((dots_m - middle_m).T @ (dots_m - middle_m))
    normal, middle_cam_m = cam_from_site @ axes[:, 0], cam_from_site @ (middle_m - site_from_cam.position_m)
    sight = middle_cam_m / np.linalg.norm(middle_cam_m)
    normal = normal if normal @ sight > 0 else -normal
    axis = np.cross(normal, sight)
    sine = float(np.linalg.norm(axis))
    turn = exp_rotation(axis * (2.0 * np.arctan2(sine, normal @ sight) / max(sine, np.finfo(np.float64).tiny)))
    rotation = site_from_cam.rotation @ turn.T
    return Pose(rotation, middle_m - rotation @ middle_cam_m)


def _shift(first: Pose, second: Pose, dots_m: Array) -> float:
    """Root mean square shift of the dots from one pose's view to the other's, normalised; infinite if one is behind."""
    views = [(dots_m - pose.position_m) @ pose.rotation for pose in (first, second)]
    if any(view[:, 2].min() <= 0 for view in views):
        return float("inf")
    one, other = (view[:, :2] / view[:, 2:] for view in views)
    return float(np.sqrt(((one - other) ** 2).sum(axis=-1).mean()))


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
