"""Consensus by sampling: when not all targets agree, pairs of targets propose who does.

RANSAC (Fischler and Bolles, CACM 24(6), 1981) with two changes: a sample is two targets, since a single small plate
says too little of where the camera points; and the score is the truncated sum of squares instead of a count.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.special import chdtri

from app.geometry.camera import INTRINSIC_COUNT
from app.geometry.rotation import log_rotation
from app.photogrammetry.resection_consensus import Consensus, ConsensusOptions, Problem, consent, own_scatter, settle
from app.photogrammetry.resection_equations import POSE_COUNT, State
from app.photogrammetry.resection_start import Start

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class SamplingOptions:
    """How pairs are sampled.

    Attributes
    ----------
    consensus : ConsensusOptions
        When a target agrees.
    sure_share : float
        Least squares over all targets that settles with this share of them agreeing needs no sampling: no other pose
        can have as many.
    scatter_share, scatter_excess : float
        Where more than this share fits, and none of the rest is further off than this many times its limit, the rest
        is no more than the scatter of covariances that promise a little too much.
    confidence : float
        Sampling ends when a pair of agreeing targets has been drawn with this probability, judged by the best so far.
    max_samples : int
        Pairs at most: half of the targets wrong takes 24 for 99.9 %.
    rival_cost : float
        Another set of targets contests the best when its cost, in targets left out, is greater by no more than this.
    rival_probability : float
        And when its pose differs by more than chance would make it this often.
    seed : int
        Of the order of the pairs: the same photograph has the same pose.
    """

    consensus: ConsensusOptions = ConsensusOptions()
    sure_share: float = 0.75
    scatter_share: float = 0.9
    scatter_excess: float = 1.5
    confidence: float = 0.999
    max_samples: int = 30
    rival_cost: float = 0.5
    rival_probability: float = 1e-3
    seed: int = 1


def find_consensus(problem: Problem, start: Start, state: State, options: SamplingOptions | None = None) -> Consensus:
    """Who agrees: all who agree with the elected proposal, less a few; otherwise the best of the sampled."""
    options = options or SamplingOptions()
    limits = options.consensus
    best = consent(problem, start.agreeing(start.elected), state, limits)
    if not _is_scatter(best, options):
        best = settle(problem, best, limits)
        if not (best.fits and best.has_share(options.sure_share)):
            best = _best(_candidates(problem, start, options), options)
    scale = own_scatter(problem, best, limits)
    settled = settle(problem, replace(best, excess=best.excess / scale), limits, scale)
    return replace(settled, contested=best.contested)


def _is_scatter(consensus: Consensus, options: SamplingOptions) -> bool:
    """Whether those who do not fit are few of many and not far off: they cannot bend the pose they are held to."""
    many = len(consensus.excess) >= options.consensus.scale_targets
    near = bool((consensus.excess[consensus.agreeing] < options.scatter_excess).all())
    return many and near and consensus.has_share(options.scatter_share)


def _candidates(problem: Problem, start: Start, options: SamplingOptions) -> list[Consensus]:
    """What pairs of targets propose, each settled, until a good pair must have been among them."""
    candidates: list[Consensus] = []
    needed, least_cost = float(options.max_samples), np.inf
    for proposer, other in _pairs(start, options):
        if len(candidates) >= needed:
            break
        pair = np.zeros(len(problem.sighted), dtype=np.bool_)
        pair[[proposer, other]] = True
        state = State(start.pose(start.between(proposer, other)), np.zeros(INTRINSIC_COUNT))
        candidates.append(settle(problem, consent(problem, pair, state, options.consensus), options.consensus))
        least_cost = min(least_cost, candidates[-1].cost)
        good_pair = np.clip((1.0 - least_cost / len(pair)) ** 2, 1.0 - options.confidence, options.confidence)
        needed = min(needed, np.log1p(-options.confidence) / np.log1p(-good_pair))
    return candidates


def _pairs(start: Start, options: SamplingOptions) -> Iterator[tuple[int, int]]:
    """Pairs of a proposer and another target, each pair once, shuffled."""
    proposers = sorted(set(start.proposers.tolist()))
    targets = range(start.misses.shape[1])
    pairs = [(i, j) for i in proposers for j in targets if j > i or (j < i and j not in proposers)]
    order = np.random.default_rng(options.seed).permutation(len(pairs))
    return (pairs[index] for index in order)


def _best(candidates: list[Consensus], options: SamplingOptions) -> Consensus:
    """The candidate of least cost, contested when another is about as good and elsewhere."""
    best = min(candidates, key=lambda candidate: candidate.cost)
    rivals = [
        candidate
        for candidate in candidates
        if candidate.has_majority
        and candidate.cost < best.cost + options.rival_cost
        and _elsewhere(best, candidate, options)
    ]
    return replace(best, contested=bool(rivals))


def _elsewhere(one: Consensus, other: Consensus, options: SamplingOptions) -> bool:
    """Whether two poses differ by more than their covariances."""
    first, second = one.adjusted.state.site_from_cam, other.adjusted.state.site_from_cam
    turn_rad = log_rotation(first.rotation @ second.rotation.T)
    difference = np.concatenate([first.position_m - second.position_m, turn_rad])
    pose = slice(0, POSE_COUNT)
    covariance = sum(np.linalg.inv(each.adjusted.information)[pose, pose] for each in (one, other))
    distance = float(difference @ np.linalg.solve(covariance, difference))
    return distance > float(chdtri(POSE_COUNT, options.rival_probability))
