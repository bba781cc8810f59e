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
from app.photogrammetry.growth import Growth
from app.photogrammetry.place_targets import place_targets
from app.photogrammetry.plate_faults import fit_plates
from app.photogrammetry.quality import QualityOptions, fault_of_plate, residual_scale, sighting_sigmas
from app.photogrammetry.robust import RobustLoss

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

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

    def __add__(self, other: Findings) -> Findings:
        return Findings(self.sightings + other.sightings, self.targets + other.targets, self.photos + other.photos)

    def __bool__(self) -> bool:
        return bool(self.sightings or self.targets or self.photos)


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


def clean_network(growth: Growth, options: QualityOptions, on_step: Callable[[], None]) -> CleanNetwork:
    """Adjust a grown network and leave out what is false."""
    findings = Findings()
    for _ in range(options.most_rounds):
        part, problem = held_part(growth)
        network = adjust_robustly(problem, growth.network.among(part.photos, part.targets), growth.options)
        growth = replace(growth, network=growth.network.with_part(network, part.photos, part.targets))
        found = _examined(growth, part, problem, options)
        if not found:
            break
        growth, findings = _without(growth, found), findings + found
        on_step()
    part, problem = held_part(growth)
    adjusted = adjust_bundle(problem, growth.network.among(part.photos, part.targets), BundleOptions(), on_step)
    return CleanNetwork(growth, part, problem, adjusted, findings)


def held_part(growth: Growth) -> tuple[Part, BundleProblem]:
    """What stands of a growth, held at its first photograph."""
    part = standing(growth)
    network = growth.network.among(part.photos, part.targets)
    return part, replace(part_problem(growth.problem, part), photo_poses=held_photo(network, 0))


def _examined(growth: Growth, part: Part, problem: BundleProblem, options: QualityOptions) -> Findings:
    """What is false in an adjusted network; the gross errors first, deformed plates when there are none."""
    network = growth.network.among(part.photos, part.targets)
    squared = squared_residuals(problem, network)
    scale = residual_scale(problem, squared, options)
    sigmas = sighting_sigmas(problem, squared, scale)
    false = sigmas > options.gross_sigmas
    sightings = problem.sightings
    share = np.bincount(sightings.photo, false, minlength=len(part.photos)) / sightings.targets_per_photo()
    lying = share > options.bad_photo_share
    if lying.any():  # nothing can be said of targets while such photographs take part
        return Findings(photos=tuple(int(photo) for photo in part.photos[lying]))
    words = fault_of_plate(
        fit_plates(problem, network, RobustLoss("cauchy", growth.options.loss_width * scale)),
        problem.u_m,
        scale,
        options,
    )
    if not false.any():
        return Findings(targets=tuple(_deformed(part, target, text) for target, text in enumerate(words) if text))
    return _false_sightings(growth, part, (sigmas, scale, words), options)


def _deformed(part: Part, target: int, words: str) -> LeftOut:
    return LeftOut(int(part.targets[target]), "deformed", words)


def _false_sightings(
    growth: Growth, part: Part, judged: tuple[Array, float, list[str | None]], options: QualityOptions
) -> Findings:
    """Tell targets that are false in themselves from sightings that are."""
    sigmas, scale, words = judged
    rows = rows_among(growth.problem.sightings, part)
    sightings = growth.problem.sightings.among(part.photos, part.targets)
    false = sigmas > options.gross_sigmas
    count = np.bincount(sightings.target, false, minlength=len(part.targets))
    share = count / sightings.rays()
    examined = (count >= FEWEST_SECOND_RAYS) & (share >= options.bad_target_share)
    distance_m = _second_places(growth, rows[false & examined[sightings.target]], scale * options.gross_sigmas)
    targets = []
    for target in np.flatnonzero(examined):
        text = words[target]
        apart_m = distance_m[part.targets[target]]
        # A deformed plate seems to shift by less than its deformation; what moves farther has moved.
        if apart_m > (0.0 if text is None else growth.problem.u_m):
            moved = f"stands in two places {apart_m:.3f} m apart: it was moved during the survey or is posted twice"
            targets.append(LeftOut(int(part.targets[target]), "moved", moved))
        elif text is not None:
            targets.append(_deformed(part, int(target), text))
    left = np.isin(sightings.target, np.searchsorted(part.targets, [found.target for found in targets]))
    single = [
        FalseSighting(
            int(part.photos[sightings.photo[row]]), int(part.targets[sightings.target[row]]), float(sigmas[row])
        )
        for row in np.flatnonzero(false & ~left)
    ]
    return Findings(tuple(single), tuple(targets))


def _second_places(growth: Growth, rows: Index, limit: float) -> Array:
    """How far from its place false sightings of a target agree on another, shape (T,), metres; 0 where they do not."""
    chosen = np.zeros(len(growth.problem.sightings), dtype=np.bool_)
    chosen[rows] = True
    problem = growth.problem.with_sightings(growth.problem.sightings.select(chosen))
    nothing = np.zeros_like(growth.decided)
    moved = place_targets(replace(growth, problem=problem, placed=nothing, decided=nothing))
    sigmas = sighting_sigmas(problem, squared_residuals(problem, moved.network), 1.0)
    agreeing = np.bincount(problem.sightings.target, sigmas < limit, minlength=problem.sightings.target_count)
    apart_m = np.linalg.norm(moved.network.target_positions_m - growth.network.target_positions_m, axis=-1)
    return np.where(agreeing >= FEWEST_SECOND_RAYS, apart_m, 0.0)


def _without(growth: Growth, found: Findings) -> Growth:
    """The growth without false sightings, and without all sightings of false targets and photographs."""
    sightings = growth.problem.sightings
    pair = sightings.photo * sightings.target_count + sightings.target
    false = np.isin(pair, [one.photo * sightings.target_count + one.target for one in found.sightings])
    false |= np.isin(sightings.target, [one.target for one in found.targets]) | np.isin(sightings.photo, found.photos)
    oriented = growth.oriented.copy()
    oriented[list(found.photos)] = False
    return replace(growth, problem=growth.problem.with_sightings(sightings.select(~false)), oriented=oriented)
