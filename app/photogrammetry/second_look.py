"""Photographs that several of their targets contradict are oriented anew before anything of them is called false.

A photograph that was oriented early, by a few targets in a row, may keep the pose that these gave it: the mirror image
of the right one, or one that leans. In the map that stands now its other targets tell, and those sightings are true.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_normals import squared_residuals
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.cleaning_state import CleaningState
from app.photogrammetry.free_adjustment import Part
from app.photogrammetry.growth import Growth
from app.photogrammetry.orient_photos import orient_photos
from app.photogrammetry.quality import QualityOptions, residual_scale, sighting_sigmas

Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

FEWEST_FALSE = 2  # sightings that contradict a photograph's pose: one is a misread code


def look_again(state: CleaningState, part: Part, problem: BundleProblem, options: QualityOptions) -> CleaningState:
    """The state with a new pose for each photograph that has fewer false sightings by it; each is asked once.

    Parameters
    ----------
    state : CleaningState
        Its network adjusted.
    part : Part
    problem : BundleProblem
        What stands of it, as it was adjusted.
    options : QualityOptions
    """
    network = state.growth.network.among(part.photos, part.targets)
    scale = residual_scale(problem, squared_residuals(problem, network), options)
    false = _false_by_photo(state.growth, part, scale * options.gross_sigmas)
    asked = np.flatnonzero((false >= FEWEST_FALSE) & ~state.looked)
    if not len(asked):
        return state
    is_asked = np.isin(np.arange(len(false)), asked)
    again = orient_photos(replace(state.growth, oriented=state.growth.oriented & ~is_asked), asked)
    found = again.oriented & (_false_by_photo(again, part, scale * options.gross_sigmas) < false)
    better = np.flatnonzero(is_asked & found)
    state = replace(state, looked=state.looked | is_asked)
    if not len(better):
        return state
    turned = again.network.photo_rotations[better], again.network.photo_positions_m[better]
    return replace(state, growth=state.growth.with_photos(better, *turned))


def _false_by_photo(growth: Growth, part: Part, limit: float) -> Index:
    """How many sightings of a part's targets each photograph of the survey shows where they are not, shape (P,)."""
    every = growth.problem.sightings
    problem = growth.problem.with_sightings(
        every.select(np.isin(every.photo, part.photos) & np.isin(every.target, part.targets))
    )
    sigmas = sighting_sigmas(problem, squared_residuals(problem, growth.network), 1.0)
    return np.bincount(problem.sightings.photo[sigmas > limit], minlength=every.photo_count)
