"""Which targets agree: consensus over targets, since a target that was moved or misread is wrong as a whole.

Each target is held against the pose that the others give. This is Baarda's test (1968) with six degrees of freedom
instead of one: a rigid movement of the target in the map. When all pass, nothing else happens; otherwise
``resection_sampling`` finds who agrees. The loss that is minimised is the truncated square per target: a target either
counts with its full weight or not at all, which keeps the covariance honest.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median

import numpy as np
import numpy.typing as npt

from app.photogrammetry.chi_square import limits_by_freedom
from app.photogrammetry.kernels.contests import contest_targets
from app.photogrammetry.resection_adjustment import AdjustedState, AdjustmentOptions, adjust_pose
from app.photogrammetry.resection_equations import CameraPrior, State, TargetEquations, linearise
from app.photogrammetry.resection_input import SightedTargets

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

# Pivot under which a direction counts as undetermined, as a fraction of the information's diagonal.
INFORMATION_RIDGE = 1e-9


@dataclass(frozen=True)
class ConsensusOptions:
    """When a target is refused.

    Attributes
    ----------
    refuse_probability : float
        A good target is refused this often: once in some 300 photographs of 30 targets.
    scale_targets : int
        Agreeing targets from which their own scatter is estimated; fewer must fit as their covariances say.
    max_scale : float
        Greatest factor by which the estimated scatter may widen the limits (3 sigmas instead of 1, squared).
    max_rounds : int
        Rounds of adjusting and testing anew.
    """

    refuse_probability: float = 1e-4
    scale_targets: int = 20
    max_scale: float = 9.0
    max_rounds: int = 6


@dataclass(frozen=True)
class Problem:
    """What stays the same during one resection.

    Attributes
    ----------
    sighted : SightedTargets
    prior : CameraPrior
    adjustment : AdjustmentOptions
    """

    sighted: SightedTargets
    prior: CameraPrior
    adjustment: AdjustmentOptions = AdjustmentOptions()

    def adjust(self, targets: Mask, start: State, free_camera: bool = True) -> AdjustedState:
        """Adjust to some of the targets."""
        return adjust_pose(self.sighted.where(targets), self.prior, start, self.adjustment, free_camera)


@dataclass(frozen=True)
class Consensus:
    """The targets that agree, and the adjustment to them.

    Attributes
    ----------
    adjusted : AdjustedState
    agreeing : ndarray of shape (K,), bool
        Who took part in the adjustment.
    chi2 : ndarray of shape (K,)
        Of each target's rigid movement against the pose that the others give.
    excess : ndarray of shape (K,)
        The same over its limit; above 1 the target does not fit.
    contested : bool
        Whether another set of targets agrees about as well on another pose.
    """

    adjusted: AdjustedState
    agreeing: Mask
    chi2: Array
    excess: Array
    contested: bool = False

    @property
    def fits(self) -> bool:
        """Whether all who took part agree."""
        return bool((self.excess[self.agreeing] <= 1.0).all())

    @property
    def cost(self) -> float:
        """Truncated sum of squares over the targets, in limits: a misfit or an outsider counts 1, however great."""
        return float(np.where(self.agreeing, np.minimum(self.excess, 1.0), 1.0).sum())

    @property
    def has_majority(self) -> bool:
        """Whether more than half of the targets agree."""
        return self.has_share(0.5)

    def has_share(self, share: float) -> bool:
        """Whether more than this share of the targets agree."""
        return bool(np.count_nonzero(self.agreeing & (self.excess <= 1.0)) > share * len(self.agreeing))


def consent(problem: Problem, targets: Mask, start: State, options: ConsensusOptions, scale: float = 1.0) -> Consensus:
    """Adjust to some targets and hold all targets against the result; ``scale`` widens the limits."""
    adjusted = problem.adjust(targets, start)
    chi2 = np.empty(len(targets))
    chi2[targets] = movements_chi2(adjusted)
    if not targets.all():
        others = linearise(problem.sighted.take(~targets), problem.prior, adjusted.state)
        chi2[~targets] = _against(others, adjusted.information, +1.0)
    limits = limits_by_freedom(options.refuse_probability)[problem.sighted.freedoms]
    return Consensus(adjusted, targets, chi2, chi2 / (scale * limits))


def settle(problem: Problem, consensus: Consensus, options: ConsensusOptions, scale: float = 1.0) -> Consensus:
    """Adjust to those who fit until they are the same as before."""
    for _ in range(options.max_rounds):
        fitting = consensus.excess <= 1.0
        if not fitting.any() or (fitting == consensus.agreeing).all():
            break
        consensus = consent(problem, fitting, consensus.adjusted.state, options, scale)
    return consensus


def own_scatter(problem: Problem, consensus: Consensus, options: ConsensusOptions) -> float:
    """How much more than their covariances say the agreeing targets scatter, by their median; 1 to ``max_scale``."""
    if np.count_nonzero(consensus.agreeing) < options.scale_targets:
        return 1.0
    expected = limits_by_freedom(0.5) / limits_by_freedom(options.refuse_probability)
    scatter = (consensus.excess / expected[problem.sighted.freedoms])[consensus.agreeing]
    return min(max(1.0, median(scatter.tolist())), options.max_scale)


def movements_chi2(adjusted: AdjustedState) -> Array:
    """Chi-square of each target's rigid movement against the pose that all the others give, shape (K,)."""
    if len(adjusted.equations.reduced) == 1:
        return np.zeros(1)  # there are no others
    return _against(adjusted.equations, adjusted.information, -1.0)


def _against(equations: TargetEquations, information: Array, sign: float) -> Array:
    """Chi-square of rigid movements against a state that the targets did not (+1) or did (-1) take part in."""
    chi2 = np.empty(len(equations.reduced))
    targets = (equations.reduced, equations.seen_from_front, equations.shape_chi2)
    contest_targets(information, targets, (sign, INFORMATION_RIDGE), chi2)
    return chi2
