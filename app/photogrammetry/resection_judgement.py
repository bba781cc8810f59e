"""Whether an adjusted pose is to be trusted: no pose is better than a wrong one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.geometry.target_map import TargetMap
from app.photogrammetry import resection_refusals as refusals
from app.photogrammetry.resection_ambiguity import Ambiguity, AmbiguityOptions
from app.photogrammetry.resection_consensus import Consensus, Problem
from app.photogrammetry.resection_doubt import Doubt
from app.photogrammetry.resection_equations import State
from app.photogrammetry.resection_uncertainty import PoseUncertainty

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class JudgementOptions:
    """When a pose is good enough.

    Attributes
    ----------
    max_sigma0 : float
        Residuals greater than this many times their standard deviations contradict the map or the camera. Detectors'
        own covariances are good to a factor of two.
    max_widening : float
        A pose whose standard deviations had to be widened by more, because a plate is seen so nearly from the front
        that its tilt stays open, is as good as ambiguous.
    max_position_sigma_m : float
        A pose less certain than this says little more than that the user is in the room.
    max_outside_m : float
        How far outside the box of the map's dots a camera may stand (pipeline.md, section 4).
    """

    max_sigma0: float = 4.0
    max_widening: float = 1.5
    max_position_sigma_m: float = 0.5
    max_outside_m: float = 20.0


@dataclass(frozen=True)
class Solution:
    """A pose with all that tells whether to trust it.

    Attributes
    ----------
    problem : Problem
    consensus : Consensus
        Which targets agree.
    ambiguity : Ambiguity
        The adjustment to them, and its mirror image.
    uncertainty : PoseUncertainty
    doubt : Doubt
        What it changes that a target may have moved by less than can be told.
    """

    problem: Problem
    consensus: Consensus
    ambiguity: Ambiguity
    uncertainty: PoseUncertainty
    doubt: Doubt

    @cached_property
    def state(self) -> State:
        """Pose and camera: the adjusted ones, averaged over doubtful targets."""
        adjusted = self.ambiguity.adjusted.state
        return adjusted.moved(self.doubt.step) if self.doubt.weights.any() else adjusted

    @property
    def covariance(self) -> Array:
        """Of the pose, shape (6, 6), without the datum."""
        return self.uncertainty.covariance + self.uncertainty.variance_factor * self.doubt.covariance

    @property
    def position_m(self) -> Array:
        """The projection centre in the site frame, shape (3,)."""
        return self.state.site_from_cam.position_m

    @property
    def sigma0(self) -> float:
        """Root of the sum of squared residuals in units of their covariance over the redundancy."""
        adjusted = self.ambiguity.adjusted
        return float(np.sqrt(adjusted.chi2 / adjusted.redundancy))


def check_consensus(problem: Problem, consensus: Consensus) -> None:
    """Refuse when no majority of the targets agrees on one pose, or two sets of them on two.

    Raises
    ------
    NotLocated
        Reason ``inconsistent``.
    """
    if not consensus.has_majority or consensus.contested:
        raise refusals.inconsistent_targets(problem.sighted.codes, consensus.agreeing & (consensus.excess <= 1.0))


def judge(
    solution: Solution, target_map: TargetMap, options: JudgementOptions, ambiguity_options: AmbiguityOptions
) -> None:
    """Refuse a pose that is not to be trusted.

    Raises
    ------
    NotLocated
        Reason ``ambiguous``, ``inconsistent``, ``too-few-dots`` or ``outside-site``.
    """
    ambiguity, uncertainty = solution.ambiguity, solution.uncertainty
    if ambiguity.is_open(ambiguity_options):
        raise refusals.ambiguous(ambiguity.ratio)
    if not ambiguity.adjusted.converged or solution.sigma0 > options.max_sigma0:
        raise refusals.inconsistent_residuals(solution.sigma0, options.max_sigma0)
    if uncertainty.widening > options.max_widening:
        raise refusals.seen_too_frontally(uncertainty.widening)
    sigma_m = float(np.sqrt(np.trace(solution.covariance[:3, :3])))
    if sigma_m > options.max_position_sigma_m:
        raise refusals.undetermined(sigma_m, options.max_position_sigma_m)
    distances_m = np.linalg.norm(solution.problem.sighted.centres_m - solution.position_m, axis=1)
    if distances_m.min() > options.max_outside_m:  # else it is no further from the box
        outside_m = _outside_m(solution.position_m, target_map)
        if outside_m > options.max_outside_m:
            raise refusals.outside_site(outside_m, options.max_outside_m)


def _outside_m(position_m: Array, target_map: TargetMap) -> float:
    """Distance of a position from the box of the map's dots, zero inside."""
    least_m, greatest_m = target_map.bounds_m()
    return float(np.linalg.norm(position_m - np.clip(position_m, least_m, greatest_m)))
