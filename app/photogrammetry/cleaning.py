"""Clean a grown network: adjust, leave out what is false and say what it is, and adjust again until nothing is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle import Adjusted, BundleOptions, adjust_bundle
from app.photogrammetry.bundle_normals import squared_residuals
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.free_adjustment import Part, adjust_robustly, held_photo, part_problem, rows_among, standing
from app.photogrammetry.grouped_prints import dissolved, with_batches, with_prints
from app.photogrammetry.growth import Growth
from app.photogrammetry.place_targets import place_targets
from app.photogrammetry.plate_faults import fit_plates
from app.photogrammetry.quality import QualityOptions, fault_of_plate, residual_scale, sighting_sigmas
from app.photogrammetry.robust import RobustLoss
from app.photogrammetry.sightings import Sightings

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

WORST_SHARE = 0.5  # of the worst residual around: what is false bends its neighbourhood, which is not false for that
FEWEST_OF_BATCH = 3  # targets of a print batch that give a free network its scale
FEWEST_SECOND_RAYS = 2  # sightings that must agree on a second place: one alone agrees with any


@dataclass(frozen=True)
class FalseSighting:
    """A target that a photograph shows where it is not: misread, or spoilt."""

    photo: int
    target: int
    sigmas: float


@dataclass(frozen=True)
class LeftOut:
    """A target that is not published: a stable reason and what to do, for a person."""

    target: int
    reason: str
    detail: str


@dataclass(frozen=True)
class Findings:
    """What was left out; photographs and targets numbered as in the survey."""

    sightings: tuple[FalseSighting, ...] = ()
    targets: tuple[LeftOut, ...] = ()
    photos: tuple[int, ...] = ()


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
    """

    growth: Growth
    part: Part
    problem: BundleProblem
    adjusted: Adjusted
    findings: Findings


@dataclass(frozen=True)
class _State:
    """A network on its way to being clean; ``false`` and ``sigmas`` belong to all sightings that it began with."""

    growth: Growth
    every: Sightings
    false: Mask
    sigmas: Array
    targets: tuple[LeftOut, ...] = ()
    photos: tuple[int, ...] = ()

    @property
    def kept(self) -> Mask:
        """Sightings that still take part: neither false themselves nor of a false target or photograph."""
        left_out = np.isin(self.every.target, [one.target for one in self.targets])
        return ~(self.false | left_out | np.isin(self.every.photo, self.photos))

    @property
    def findings(self) -> Findings:
        """What was left out; a target or photograph that is left out speaks for its sightings."""
        single = self.false & ~np.isin(self.every.target, [one.target for one in self.targets])
        rows = np.flatnonzero(single & ~np.isin(self.every.photo, self.photos))
        sightings = [
            FalseSighting(int(self.every.photo[row]), int(self.every.target[row]), float(self.sigmas[row]))
            for row in rows
        ]
        return Findings(tuple(sightings), self.targets, self.photos)


def clean_network(growth: Growth, options: QualityOptions, on_step: Callable[[], None]) -> CleanNetwork:
    """Adjust a grown network and leave out what is false."""
    every = growth.problem.sightings
    state = _State(growth, every, np.zeros(len(every), dtype=np.bool_), np.zeros(len(every)))
    regroupings = 0
    for _ in range(options.most_rounds + options.most_regroupings):
        on_step()
        part, problem = held_part(state.growth)
        start = state.growth.network.among(part.photos, part.targets)
        network = adjust_robustly(problem, start, growth.capture_loss, growth.options)
        placed = state.growth.network.with_part(network, part.photos, part.targets)
        state = replace(state, growth=replace(state.growth, network=placed))
        grouped = with_batches(state.growth, part, problem) if regroupings < options.most_regroupings else None
        if grouped is not None:
            state, regroupings = replace(state, growth=grouped), regroupings + 1
            continue
        after = _without_false(state, part, problem, options)
        if after.kept.sum() == state.kept.sum():
            break
        state = after
    state = _readmitted(state, options)
    part, problem, adjusted = _adjusted(state, on_step)
    fewer = dissolved(problem, adjusted.network, state.growth.options.batches)
    if fewer is not None:
        state = replace(state, growth=with_prints(state.growth, part, *fewer))
        part, problem, adjusted = _adjusted(state, on_step)
    return CleanNetwork(state.growth, part, problem, adjusted, state.findings)


def _adjusted(state: _State, on_step: Callable[[], None]) -> tuple[Part, BundleProblem, Adjusted]:
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


def _without_false(state: _State, part: Part, problem: BundleProblem, options: QualityOptions) -> _State:
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
        return _reduced(replace(state, targets=state.targets + deformed))
    rows = np.flatnonzero(state.kept)[rows_among(growth.problem.sightings, part)]
    worst = rows[gross & _worst_around(problem.sightings, sigmas)]
    values = state.sigmas.copy()
    values[rows] = sigmas
    state = replace(state, false=state.false | np.isin(np.arange(len(state.false)), worst), sigmas=values)
    state = replace(state, photos=_lying_photos(state, options))
    return _reduced(_with_examined(state, words, scale * options.gross_sigmas, options))


def _readmitted(state: _State, options: QualityOptions) -> _State:
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
    return _reduced(replace(state, false=false))


def _worst_around(sightings: Sightings, sigmas: Array) -> Mask:
    """Sightings about as bad as the worst of their photograph and of their target: what is false drags others along."""
    of_photo, of_target = np.zeros(sightings.photo_count), np.zeros(sightings.target_count)
    np.maximum.at(of_photo, sightings.photo, sigmas)
    np.maximum.at(of_target, sightings.target, sigmas)
    return np.asarray(sigmas >= WORST_SHARE * np.maximum(of_photo[sightings.photo], of_target[sightings.target]))


def _lying_photos(state: _State, options: QualityOptions) -> tuple[int, ...]:
    """Photographs that have lost too great a share of their sightings."""
    seen = np.maximum(np.bincount(state.every.photo, minlength=state.every.photo_count), 1)
    share = np.bincount(state.every.photo, state.false, minlength=state.every.photo_count) / seen
    return tuple(int(photo) for photo in np.flatnonzero(share > options.bad_photo_share))


def _with_examined(state: _State, words: dict[int, str | None], limit: float, options: QualityOptions) -> _State:
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
            moved = f"stands in two places {apart_m:.3f} m apart: it was moved during the survey or is posted twice"
            found.append(LeftOut(int(target), "moved", moved))
        elif text is not None:
            found.append(LeftOut(int(target), "deformed", text))
    return replace(state, targets=state.targets + tuple(found))


def _second_places(state: _State, chosen: Mask, limit: float) -> Array:
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


def _reduced(state: _State) -> _State:
    """The state with its network deprived of what is false."""
    oriented = state.growth.oriented.copy()
    oriented[list(state.photos)] = False
    problem = state.growth.problem.with_sightings(state.every.select(state.kept))
    return replace(state, growth=replace(state.growth, problem=problem, oriented=oriented))
