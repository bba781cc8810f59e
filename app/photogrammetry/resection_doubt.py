"""Targets that may have moved, though no test can tell: the pose is averaged over who is left out.

A target that was displaced by less than the others can tell passes the test that refuses it (minimal detectable bias:
Baarda, 1968), and of three targets such a one may move the pose by many of its sigmas (external reliability). Each
single target is therefore doubted: the odds that it moved grow with the likelihood ratio of its rigid movement. The
pose is the mean over the hypotheses "nobody moved" and "this one moved", and its covariance holds what they differ by
(Bayesian model averaging: Hoeting et al., Statistical Science 14(4), 1999, equations 1 to 3).

Three targets leave hardly anything to test by: the dots of two fix where the third one must stand to centimetres only.
There each one is doubted beforehand, so that the covariance covers a pose without it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.chi_square import limits_by_freedom
from app.photogrammetry.resection_adjustment import AdjustedState
from app.photogrammetry.resection_equations import POSE_COUNT, STATE_COUNT

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class DoubtOptions:
    """When a target is doubted.

    Attributes
    ----------
    even_probability : float
        A movement that chance exceeds this often is as likely as none: the rate of targets that were moved by
        millimetres, with what it costs a hypothesis to explain a photograph by six numbers of its own.
    least_probability : float
        A movement that chance exceeds more often is no ground for doubt.
    fewest_targets : int
        Of two targets that disagree neither can be told from the other; the test refuses them both.
    few_targets : int
        Of so many targets each is doubted whatever the evidence.
    few_odds : float
        By these odds. With 0.1 one of three that was displaced moves the position by no more than its own standard
        deviation in the root mean square, whatever the displacement (``python -m benchmarks.pose_displaced``).
    """

    even_probability: float = 1e-2
    least_probability: float = 0.05
    fewest_targets: int = 3
    few_targets: int = 3
    few_odds: float = 0.1


@dataclass(frozen=True)
class Doubt:
    """What leaving out single targets changes.

    Attributes
    ----------
    weights : ndarray of shape (K,)
        Probability that each target moved, at most one of them; they add up to less than 1.
    step : ndarray of shape (15,)
        From the adjusted state to the mean over the hypotheses.
    covariance : ndarray of shape (6, 6)
        What doubt adds to the pose's: the lost targets, and how far the hypotheses lie apart.
    """

    weights: Array
    step: Array
    covariance: Array


def doubt_targets(
    adjusted: AdjustedState, chi2: Array, freedoms: npt.NDArray[np.intp], options: DoubtOptions | None = None
) -> Doubt:
    """Doubt each of the targets that were adjusted.

    Parameters
    ----------
    adjusted : AdjustedState
    chi2 : ndarray of shape (K,)
        Of each target's rigid movement against the pose that the others give (``movements_chi2``).
    freedoms : ndarray of shape (K,), int
        Degrees of freedom of each movement.
    options : DoubtOptions, optional
    """
    weights = _weights(chi2, freedoms, options or DoubtOptions())
    step, covariance = np.zeros(STATE_COUNT), np.zeros((POSE_COUNT, POSE_COUNT))
    doubted = np.flatnonzero(weights)
    if doubted.size:
        without: Array = np.asarray(np.linalg.inv(adjusted.information - adjusted.equations.information[doubted]))
        steps = (without @ adjusted.equations.gradient[doubted][..., None])[..., 0]
        step = weights[doubted] @ steps
        covariance = _spread(adjusted, weights[doubted], without, steps)
    return Doubt(weights, step, covariance)


def _weights(chi2: Array, freedoms: npt.NDArray[np.intp], options: DoubtOptions) -> Array:
    """Probabilities of the hypotheses that one target moved, shape (K,), from chi-squares of their movements."""
    if len(chi2) < options.fewest_targets:
        return np.zeros(len(chi2))
    even, least = (limits_by_freedom(p)[freedoms] for p in (options.even_probability, options.least_probability))
    log_odds = np.where(chi2 > least, (chi2 - even) / 2.0, -np.inf)
    if len(chi2) <= options.few_targets:
        log_odds = np.maximum(log_odds, np.log(options.few_odds))
    top = max(0.0, float(log_odds.max()))
    odds = np.exp(log_odds - top)
    return np.asarray(odds / (np.exp(-top) + odds.sum()))


def _spread(adjusted: AdjustedState, weights: Array, without: Array, steps: Array) -> Array:
    """What the hypotheses add to the covariance of the pose: the lost targets, and how far apart the poses lie.

    ``without`` and ``steps`` are the covariance (15, 15) and the step (15,) of each hypothesis that leaves one out.
    """
    pose = slice(0, POSE_COUNT)
    everyone = adjusted.covariance[pose, pose]
    steps = steps[:, pose]
    mean = weights @ steps
    lost = (weights[:, None, None] * (without[:, pose, pose] - everyone)).sum(axis=0)
    return np.asarray(lost + (steps.T * weights) @ steps - np.outer(mean, mean))
