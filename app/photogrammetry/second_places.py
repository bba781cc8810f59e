"""Targets whose false sightings agree on a second place: moved during the survey, or posted twice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_normals import squared_residuals
from app.photogrammetry.cleaning_state import CleaningState, LeftOut
from app.photogrammetry.free_adjustment import Part, rows_among
from app.photogrammetry.network import POSE_COUNT
from app.photogrammetry.place_targets import place_targets
from app.photogrammetry.quality import QualityOptions, residual_scale, sighting_sigmas
from app.photogrammetry.split_targets import SplitTarget

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

FEWEST_SECOND_RAYS = 2  # sightings that must agree on a second place: one alone agrees with any


def with_examined(
    state: CleaningState, words: dict[int, str | None], limit: float, options: QualityOptions
) -> CleaningState:
    """Leave out the targets that are false in themselves: moved, posted twice, not as printed."""
    every = state.every
    rays, count = every.rays(), np.bincount(every.target, state.false, minlength=every.target_count)
    examined = (count >= FEWEST_SECOND_RAYS) & (count >= options.bad_target_share * rays)
    examined[[one.target for one in state.targets]] = False
    distances_m = _second_places(state, state.false & examined[every.target], limit)
    found = []
    for target in np.flatnonzero(examined):
        text, apart_m = words.get(int(target)), distances_m[target]
        # A deformed plate seems to shift by less than its deformation; what moves farther has moved.
        if apart_m > (0.0 if text is None else state.growth.problem.u_m):
            found.append(_moved(int(target), apart_m))
        elif text is not None:
            found.append(LeftOut(int(target), "deformed", text))
    return replace(state, targets=state.targets + tuple(found))


def moved_after_all(state: CleaningState, options: QualityOptions) -> CleaningState:
    """Leave out targets of which only few sightings were called false in the end, but these agree on a second place.

    The adjustment puts a target where most of its photographs saw it; of the others only those that show the
    difference best are false. Photographs that have lost much else say nothing: they are wrong themselves.
    """
    every = state.every
    seen = np.maximum(np.bincount(every.photo, minlength=every.photo_count), 1)
    spoilt = np.bincount(every.photo, state.false, minlength=every.photo_count) > options.bad_target_share * seen
    chosen = state.false & ~np.isin(every.target, [one.target for one in state.targets]) & ~spoilt[every.photo]
    chosen &= (np.bincount(every.target, chosen, minlength=every.target_count) >= FEWEST_SECOND_RAYS)[every.target]
    if not chosen.any():
        return state
    kept = state.growth.problem
    scale = residual_scale(kept, squared_residuals(kept, state.growth.network), options)
    distances_m = _second_places(state, chosen, options.gross_sigmas * scale)
    found = tuple(_moved(int(target), distances_m[target]) for target in np.flatnonzero(distances_m))
    return replace(state, targets=state.targets + found).reduced()


def without_split(state: CleaningState, part: Part, split: Sequence[SplitTarget]) -> CleaningState:
    """Leave out what stands in two places in a part of the network: targets, or their one sighting elsewhere."""
    rows = np.flatnonzero(state.kept)[rows_among(state.growth.problem.sightings, part)]
    false, sigmas = state.false.copy(), state.sigmas.copy()
    for one in split:
        if one.lone is not None:
            false[rows[one.lone]], sigmas[rows[one.lone]] = True, np.sqrt(one.gain / POSE_COUNT)
    moved = tuple(_moved(int(part.targets[one.target]), one.apart_m) for one in split if one.lone is None)
    return replace(state, false=false, sigmas=sigmas, targets=state.targets + moved).reduced()


def _moved(target: int, apart_m: float) -> LeftOut:
    moved = f"stands in two places {apart_m:.3f} m apart: it was moved during the survey or is posted twice"
    return LeftOut(target, "moved", moved)


def _second_places(state: CleaningState, chosen: Mask, limit: float) -> Array:
    """How far from its place false sightings of a target agree on another, shape (T,), metres; 0 where they do not."""
    growth = state.growth
    problem = growth.problem.with_sightings(state.every.select(chosen & growth.oriented[state.every.photo]))
    nothing = np.zeros_like(growth.decided)
    # Both places may be among the false sightings: they are told apart by what the adjusted network tolerates.
    sharp = replace(growth.options, tolerance=growth.tolerance * limit / growth.capture_loss.width)
    moved = place_targets(replace(growth, problem=problem, placed=nothing, decided=nothing, options=sharp))
    sightings = problem.sightings
    sigmas = sighting_sigmas(problem, squared_residuals(problem, moved.network), 1.0)
    agreeing = np.bincount(sightings.target, sigmas < limit, minlength=sightings.target_count)
    apart_m = np.linalg.norm(moved.network.target_positions_m - growth.network.target_positions_m, axis=-1)
    return np.where(agreeing >= FEWEST_SECOND_RAYS, apart_m, 0.0)
