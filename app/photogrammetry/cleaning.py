"""Clean a grown network: adjust, leave out what is false and say what it is, and adjust again until nothing is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle import Adjusted, BundleOptions, adjust_bundle
from app.photogrammetry.bundle_normals import squared_residuals
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.cleaning_state import CleaningState, Findings, LeftOut, untouched
from app.photogrammetry.detectable import least_detectable_m
from app.photogrammetry.free_adjustment import Part, adjust_robustly, held_photo, part_problem, rows_among, standing
from app.photogrammetry.grouped_prints import dissolved, with_batches, with_prints
from app.photogrammetry.growth import Growth
from app.photogrammetry.plate_faults import fit_plates
from app.photogrammetry.quality import QualityOptions, fault_of_plate, residual_scale, sighting_sigmas
from app.photogrammetry.robust import RobustLoss
from app.photogrammetry.second_look import look_again
from app.photogrammetry.second_places import moved_after_all, with_examined, without_split
from app.photogrammetry.sightings import Sightings
from app.photogrammetry.split_targets import SplitOptions, SplitTarget, split_of, surest_around
from app.photogrammetry.target_pulls import target_pulls

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

WORST_SHARE = 0.5  # of the worst residual around: what is false bends its neighbourhood, which is not false for that
FEWEST_OF_BATCH = 3  # targets of a print batch that give a free network its scale


@dataclass(frozen=True)
class CleanNetwork:
    """An adjusted free network of true observations.

    Attributes
    ----------
    growth : Growth
        The network it came from, without what was left out.
    part : Part
        Photographs and targets of the survey that are in it.
    problem : BundleProblem
        Their observations, renumbered, held at one photograph.
    adjusted : Adjusted
    findings : Findings
        What was left out.
    detectable_m : ndarray of shape (T,)
        Least displacement during the survey by which each of its targets would have been found.
    """

    growth: Growth
    part: Part
    problem: BundleProblem
    adjusted: Adjusted
    findings: Findings
    detectable_m: Array


def clean_network(growth: Growth, options: QualityOptions, on_step: Callable[[], None]) -> CleanNetwork:
    """Adjust a grown network and leave out what is false."""
    state = _without_contradictions(untouched(growth), options, on_step)
    state = moved_after_all(_readmitted(state, options), options)
    for rounds_left in range(options.split.most_rounds, -1, -1):
        state, part, problem, adjusted = _adjusted(state, on_step)
        split, detectable_m = _in_two_places(problem, adjusted, options.split)
        if not (split and rounds_left):
            break
        state, _, _ = _settled(without_split(state, part, split))
        state = _readmitted(state, options)
    return CleanNetwork(state.growth, part, problem, adjusted, state.findings, detectable_m)


def _in_two_places(
    problem: BundleProblem, adjusted: Adjusted, options: SplitOptions
) -> tuple[tuple[SplitTarget, ...], Array]:
    """The surest of the targets that stand in two places, and how far each would have had to move to be found."""
    pulls, found = target_pulls(problem, adjusted.network, BundleOptions().loss), list[SplitTarget]()
    # Targets with too few sightings for two places are never found.
    least_m = np.full(problem.sightings.target_count, np.inf)
    for one in pulls:
        least_m[one.target] = least_detectable_m(one, len(pulls), options)
        split = split_of(one, len(pulls), options)
        if split is not None:
            found.append(split)
    return surest_around(found, problem.sightings), least_m


def _without_contradictions(
    state: CleaningState, options: QualityOptions, on_step: Callable[[], None]
) -> CleaningState:
    """The state without sightings, targets and photographs that the rest contradicts."""
    regroupings = 0
    for _ in range(options.most_rounds + options.most_regroupings):
        on_step()
        state, part, problem = _settled(state)
        grouped = with_batches(state.growth, part, problem) if regroupings < options.most_regroupings else None
        if grouped is not None:
            state, regroupings = replace(state, growth=grouped), regroupings + 1
            continue
        looked = look_again(state, part, problem, options)
        if looked.growth is not state.growth:
            state = looked
            continue
        after = _without_false(looked, part, problem, options)
        if after.kept.sum() == state.kept.sum():
            break
        state = after
    return state


def _settled(state: CleaningState) -> tuple[CleaningState, Part, BundleProblem]:
    """The state with what stands of its network adjusted, and what that is."""
    growth = state.growth
    part, problem = held_part(growth)
    network = growth.network.among(part.photos, part.targets)
    network = adjust_robustly(problem, network, growth.capture_loss, growth.options)
    placed = growth.network.with_part(network, part.photos, part.targets)
    return replace(state, growth=replace(growth, network=placed)), part, problem


def _adjusted(state: CleaningState, on_step: Callable[[], None]) -> tuple[CleaningState, Part, BundleProblem, Adjusted]:
    """What stands with its final weights, without print batches that it does not bear out."""
    part, problem, adjusted = _with_final_weights(state, on_step)
    fewer = dissolved(problem, adjusted.network, state.growth.options.batches)
    if fewer is not None:
        state = replace(state, growth=with_prints(state.growth, part, *fewer))
        part, problem, adjusted = _with_final_weights(state, on_step)
    return state, part, problem, adjusted


def _with_final_weights(state: CleaningState, on_step: Callable[[], None]) -> tuple[Part, BundleProblem, Adjusted]:
    part, problem = held_part(state.growth)
    start = state.growth.network.among(part.photos, part.targets)
    return part, problem, adjust_bundle(problem, start, BundleOptions(), on_step)


def held_part(growth: Growth) -> tuple[Part, BundleProblem]:
    """What stands of a growth, held at its first photograph."""
    part = standing(growth, growth.options.fewest_agreeing)
    network = growth.network.among(part.photos, part.targets)
    problem = part_problem(growth.problem, part)
    prints = problem.prints.held_at(problem.prints.best_known(FEWEST_OF_BATCH))
    return part, replace(problem, prints=prints, photo_poses=held_photo(network, 0))


def _without_false(state: CleaningState, part: Part, problem: BundleProblem, options: QualityOptions) -> CleaningState:
    """The state without the worst of what is false; deformed plates are sought when no sighting is."""
    growth = state.growth
    network = growth.network.among(part.photos, part.targets)
    squared = squared_residuals(problem, network)
    scale = residual_scale(problem, squared, options)
    sigmas = sighting_sigmas(problem, squared, scale)
    fits = fit_plates(problem, network, RobustLoss("cauchy", growth.options.loss_width * scale))
    words = dict(zip(part.targets.tolist(), fault_of_plate(fits, problem.u_m, scale, options), strict=True))
    gross = sigmas > options.gross_sigmas
    if not gross.any():
        deformed = tuple(LeftOut(target, "deformed", text) for target, text in words.items() if text is not None)
        return replace(state, targets=state.targets + deformed).reduced()
    rows = np.flatnonzero(state.kept)[rows_among(growth.problem.sightings, part)]
    worst = rows[gross & _worst_around(problem.sightings, sigmas)]
    values = state.sigmas.copy()
    values[rows] = sigmas
    state = replace(state, false=state.false | np.isin(np.arange(len(state.false)), worst), sigmas=values)
    state = replace(state, photos=_lying_photos(state, options))
    return with_examined(state, words, scale * options.gross_sigmas, options).reduced()


def _readmitted(state: CleaningState, options: QualityOptions) -> CleaningState:
    """The state with sightings back that were called false while others bent the network, and agree with it now."""
    growth = state.growth
    part = standing(growth, growth.options.fewest_agreeing)
    asked = state.false & ~np.isin(state.every.target, [one.target for one in state.targets])
    asked &= np.isin(state.every.target, part.targets) & np.isin(state.every.photo, part.photos)
    if not asked.any():
        return state
    kept = growth.problem
    scale = residual_scale(kept, squared_residuals(kept, growth.network), options)
    problem = kept.with_sightings(state.every.select(asked))
    sigmas = sighting_sigmas(problem, squared_residuals(problem, growth.network), scale)
    false = state.false.copy()
    false[np.flatnonzero(asked)[sigmas <= options.gross_sigmas]] = False
    return replace(state, false=false).reduced()


def _worst_around(sightings: Sightings, sigmas: Array) -> Mask:
    """Sightings about as bad as the worst of their photograph and of their target: what is false drags others along."""
    of_photo, of_target = np.zeros(sightings.photo_count), np.zeros(sightings.target_count)
    np.maximum.at(of_photo, sightings.photo, sigmas)
    np.maximum.at(of_target, sightings.target, sigmas)
    return np.asarray(sigmas >= WORST_SHARE * np.maximum(of_photo[sightings.photo], of_target[sightings.target]))


def _lying_photos(state: CleaningState, options: QualityOptions) -> tuple[int, ...]:
    """Photographs that have lost too great a share of their sightings."""
    seen = np.maximum(np.bincount(state.every.photo, minlength=state.every.photo_count), 1)
    share = np.bincount(state.every.photo, state.false, minlength=state.every.photo_count) / seen
    return tuple(int(photo) for photo in np.flatnonzero(share > options.bad_photo_share))
