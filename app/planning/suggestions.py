"""Where should the next target go? The free place on the walls that mends most of what a site's targets leave open.

Greedy: each suggestion is the best one after all before it. First count views that cannot be located for want of
targets; then the worst radius over the grid; then the mean square of all, so that a place without effect on the worst
view still counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.geometry.target_map import TargetMap
from app.photogrammetry.resection_equations import STATE_COUNT, CameraPrior
from app.planning.candidates import Candidate, CandidateOptions, find_candidates
from app.planning.coverage import headings_of, make_grid, poses_at
from app.planning.plan_view import ViewWish
from app.planning.plan_walls import Wall
from app.planning.planned_map import planned_target
from app.planning.predicted_accuracy import datum_covariances, position_covariances, radius95, sighting_information
from app.planning.predicted_views import MapArrays, Seeing, predict_views
from app.planning.sight_lines import find_sight_lines
from app.targets.choosing import choose_codes
from app.targets.family import family_by_name

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Over = Literal["best", "middle", "worst"]

OVERS: tuple[Over, ...] = ("best", "middle", "worst")


@dataclass(frozen=True)
class SuggestionOptions:
    """How many suggestions, and what counts.

    Attributes
    ----------
    count : int
    over : str
        Which headings of each position count: all down to the worst, the better half, or the best alone.
    candidates : CandidateOptions
    most_views : int
        Positions times headings; a finer grid is thinned: normal matrices are held, 1.8 kB for each target in a view.
    """

    count: int = 3
    over: Over = "worst"
    candidates: CandidateOptions = CandidateOptions()
    most_views: int = 4_000


@dataclass(frozen=True)
class Standing:
    """How a set of targets does over the grid.

    Attributes
    ----------
    lacking : int
        Targets that views lack until each can be located.
    worst_m : float
        Greatest 95 % radius of the positions that can be located; infinite where none can.
    rms_m : float
        Root mean square of those radii.
    """

    lacking: int
    worst_m: float
    rms_m: float

    @property
    def order(self) -> tuple[int, float, float]:
        """Less is better."""
        return self.lacking, self.worst_m, self.rms_m


@dataclass(frozen=True)
class Suggestion:
    """A target to be posted at a free place, with a code of its own, and how the site stands before and after."""

    place: Candidate
    before: Standing
    after: Standing


@dataclass(frozen=True)
class _Gain:
    """What a candidate adds: normal matrices (K, 15, 15) of the views that would see it."""

    views: Index
    matrices: Array


@dataclass
class _Board:
    """All views of a grid and what is known in them; ``post`` changes it.

    Attributes
    ----------
    matrices : ndarray of shape (V, 15, 15)
    counts : ndarray of shape (V,)
        Targets in view.
    datum : ndarray of shape (V, 3, 3)
    headings : int
        Views follow each other by position, then heading.
    least : int
        Targets that a view needs.
    over : str
    """

    matrices: Array
    counts: Index
    datum: Array
    headings: int
    least: int
    over: Over
    radii_m: Array = field(init=False)

    def __post_init__(self) -> None:
        everything = np.arange(len(self.counts))
        self.radii_m = self._radii_m(everything, self.matrices, self.counts)

    def standing(self) -> Standing:
        """As it is."""
        return self._summary(self.radii_m, self.counts)

    def standing_with(self, gain: _Gain) -> Standing:
        """As it would be with one target more."""
        radii_m, counts = self.radii_m.copy(), self.counts.copy()
        counts[gain.views] += 1
        radii_m[gain.views] = self._radii_m(gain.views, self.matrices[gain.views] + gain.matrices, counts[gain.views])
        return self._summary(radii_m, counts)

    def post(self, gain: _Gain) -> None:
        """Have one target more."""
        self.matrices[gain.views] += gain.matrices
        self.counts[gain.views] += 1
        self.radii_m[gain.views] = self._radii_m(gain.views, self.matrices[gain.views], self.counts[gain.views])

    def _radii_m(self, views: Index, matrices: Array, counts: Index) -> Array:
        enough, radii_m = counts >= self.least, np.full(len(views), np.inf)
        radii_m[enough] = radius95(position_covariances(matrices[enough], self.datum[views[enough]]))
        return radii_m

    def _summary(self, radii_m: Array, counts: Index) -> Standing:
        """Of the headings that count: worse is a heading with more targets lacking, then with a greater radius."""
        lacking = np.maximum(self.least - counts, 0).reshape(-1, self.headings)
        radii_m = radii_m.reshape(-1, self.headings)
        last = {"best": 0, "middle": (self.headings - 1) // 2, "worst": self.headings - 1}[self.over]
        counted = np.lexsort((radii_m, lacking), axis=1)[:, : last + 1]
        of_positions_m = np.take_along_axis(radii_m, counted, axis=1)
        located_m = of_positions_m[np.isfinite(of_positions_m)]
        short = int(np.take_along_axis(lacking, counted, axis=1).sum())
        if not len(located_m):
            return Standing(short, np.inf, np.inf)
        return Standing(short, float(located_m.max()), float(np.sqrt((located_m**2).mean())))


def suggest_targets(
    target_map: TargetMap,
    walls: Sequence[Wall],
    seeing: Seeing,
    wish: ViewWish,
    options: SuggestionOptions = SuggestionOptions(),
) -> tuple[Suggestion, ...]:
    """Places for the next targets, best first; fewer than asked for when nothing more would help.

    Parameters
    ----------
    target_map : TargetMap
    walls : sequence of Wall
        On whose fronts targets may hang.
    seeing : Seeing
    wish : ViewWish
    options : SuggestionOptions, optional

    Raises
    ------
    InvalidInput
        When no wall has a free place, the family no code, or the grid no position.
    """
    candidates = find_candidates(target_map, walls, options.candidates)
    board, gains = _look(target_map, candidates, walls, (seeing, _thinned(target_map, walls, wish, options), options))
    chosen: list[Suggestion] = []
    standing = board.standing()
    while len(chosen) < options.count and gains:
        ranked = {index: board.standing_with(gain) for index, gain in gains.items()}
        best = min(ranked, key=lambda index: ranked[index].order)
        if ranked[best].order >= standing.order:
            break
        chosen.append(Suggestion(candidates[best], standing, ranked[best]))
        standing = ranked[best]
        board.post(gains[best])
        at_m = candidates[best].posted.site_from_target.position_m
        gains = {index: gain for index, gain in gains.items() if not candidates[index].covers(at_m)}
    return _coded(chosen, target_map)


def _thinned(target_map: TargetMap, walls: Sequence[Wall], wish: ViewWish, options: SuggestionOptions) -> ViewWish:
    """The wish with a step that keeps the views few."""
    views = len(make_grid(target_map, walls, wish).cells) * wish.headings
    return replace(wish, step_m=wish.step_m * max(1.0, float(np.sqrt(views / options.most_views))))


def _look(
    target_map: TargetMap,
    candidates: list[Candidate],
    walls: Sequence[Wall],
    how: tuple[Seeing, ViewWish, SuggestionOptions],
) -> tuple[_Board, dict[int, _Gain]]:
    """What the targets tell each view, and what each candidate would add."""
    seeing, wish, options = how
    hanging = len(target_map.targets)
    everything = [*target_map.targets, *(planned_target(one.posted, wish.survey) for one in candidates)]
    arrays, prior, grid = MapArrays.of(everything), CameraPrior.of(seeing.camera), make_grid(target_map, walls, wish)
    lines = find_sight_lines(grid.positions_m, everything, walls, (seeing.camera.camera.fx_px, seeing.limits))
    headings_rad = headings_of(wish)
    found_views, found_targets, found = [], [], []
    for index, position_m in enumerate(grid.positions_m):
        views = predict_views(arrays, lines.of(index), poses_at(position_m, headings_rad, wish), seeing)
        found_views.append(index * wish.headings + np.repeat(np.arange(wish.headings), np.diff(views.starts)))
        found_targets.append(views.target)
        found.append(sighting_information(views, prior))
    view, target = np.concatenate(found_views), np.concatenate(found_targets)
    information = np.concatenate(found)
    count, old = len(grid.positions_m) * wish.headings, target < hanging
    matrices = np.zeros((count, STATE_COUNT, STATE_COUNT))
    np.add.at(matrices, view[old], information[old])
    datum = np.repeat(datum_covariances(target_map.datum, grid.positions_m), wish.headings, axis=0)
    counts = np.bincount(view[old], minlength=count)
    board = _Board(matrices, counts, datum, wish.headings, seeing.limits.min_targets, options.over)
    seen = np.unique(target[~old])
    return board, {int(one) - hanging: _Gain(view[target == one], information[target == one]) for one in seen}


def _coded(chosen: list[Suggestion], target_map: TargetMap) -> tuple[Suggestion, ...]:
    """The suggestions with a code each."""
    if not chosen:
        return ()
    codes = choose_codes(family_by_name(target_map.code_family), len(chosen), target_map.by_code.keys())
    places = (
        replace(one.place, posted=replace(one.place.posted, code=code)) for one, code in zip(chosen, codes, strict=True)
    )
    return tuple(replace(one, place=place) for one, place in zip(chosen, places, strict=True))
