"""Targets that moved by too little for single sightings to be false, but whose sightings fall into two groups.

A target that was moved between photographs stands in two places, and the adjustment puts it between them. Each sighting
is then off by half of the way, which may be less than what calls a sighting false; all of them together tell.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.collinearity import linearise
from app.photogrammetry.network import POSE_COUNT, Network

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

FEWEST_OF_PLACE = 2  # sightings: one alone agrees with any place
GROUPINGS = 10  # after which no sighting changes its group any more
RIDGE = 1e-9  # of the strongest direction: dots of two sightings fix all six unknowns far better


@dataclass(frozen=True)
class SplitOptions:
    """When a target stands in two places.

    Attributes
    ----------
    least_sigmas : float
        Root mean square residual of its sightings, in standard deviations, from which a target is looked at; in each of
        the two places it must be less. Sightings of sound targets have 1, with what their dots share 1.7 at most.
        Photographs of which half of the sightings have more say nothing.
    most_sigmas : float
        Of a sighting: what is farther off is another plate, and one step from where the target stands does not tell
        where.
    least_fall : float
        Factor by which two places lower the weighted squares. The best grouping of noise makes it 1.4 at most, and that
        of what a lens leaves that breathes by 0.3 % up to 7.
    most_rounds : int
        Adjustments in which the worst target around is left out.
    """

    least_sigmas: float = 2.0
    most_sigmas: float = 20.0
    least_fall: float = 9.0
    most_rounds: int = 5


@dataclass(frozen=True)
class SplitTarget:
    """A target in two places, so far apart, and by how much these lower the weighted squares, in variances."""

    target: int
    apart_m: float
    gain: float


@dataclass(frozen=True)
class _Views:
    """What each of n sightings says of one target's step x: its squares are ``squares + 2 g' x + x' N x``."""

    information: Array  # (n, 6, 6)
    gradient: Array  # (n, 6)
    squares: Array  # (n,)
    numbers: Array  # (n,), coordinates measured

    def step(self, chosen: Mask) -> Array:
        """The step of least squares of some sightings, shape (6,)."""
        normal = self.information[chosen].sum(axis=0)
        normal = normal + RIDGE * np.diag(np.diag(normal))
        return -np.asarray(np.linalg.solve(normal, self.gradient[chosen].sum(axis=0)))

    def after(self, step: Array) -> Array:
        """Squares of each sighting after a step, shape (n,)."""
        return np.asarray(self.squares + 2.0 * self.gradient @ step + (self.information @ step) @ step)


def split_targets(
    problem: BundleProblem, network: Network, scale: float, options: SplitOptions
) -> tuple[SplitTarget, ...]:
    """Targets that stand in two places; of those that photographs show together the surest only.

    Parameters
    ----------
    problem : BundleProblem
        All sightings that may tell, also those that were called false.
    network : Network
        Adjusted.
    scale : float
        Standard deviation of the residuals, as a multiple of the stated one.
    options : SplitOptions
    """
    every = _views(problem, network, scale)
    sigmas = np.sqrt(every.squares / every.numbers)
    told = (sigmas < options.most_sigmas) & _sound_photos(problem, sigmas, options)[problem.sightings.photo]
    found = []
    for target, rows in _by_target(problem.sightings.target, told):
        views = _Views(every.information[rows], every.gradient[rows], every.squares[rows], every.numbers[rows])
        split = _split(target, views, options)
        if split is not None:
            found.append(split)
    return _surest_around(found, problem)


def _views(problem: BundleProblem, network: Network, scale: float) -> _Views:
    sightings = problem.sightings
    products = np.empty((len(sightings), POSE_COUNT + 1, POSE_COUNT + 1))
    for camera, chunk in problem.chunks():
        equations = linearise(network, sightings.select(chunk), problem.camera_at(network, camera), problem.plane_m)
        rows = np.concatenate([equations.jacobian[..., :POSE_COUNT], equations.residuals[..., None]], axis=-1)
        rows = rows.reshape(len(rows), -1, POSE_COUNT + 1) / scale
        products[chunk] = np.swapaxes(rows, -1, -2) @ rows
    numbers = 2.0 * sightings.measured.sum(axis=-1)
    return _Views(products[:, :-1, :-1], products[:, :-1, -1], products[:, -1, -1], numbers)


def _sound_photos(problem: BundleProblem, sigmas: Array, options: SplitOptions) -> Mask:
    """Photographs most of whose sightings fit, shape (P,)."""
    count = problem.sightings.photo_count
    fitting = np.bincount(problem.sightings.photo, sigmas < options.least_sigmas, minlength=count)
    return np.asarray(2.0 * fitting > problem.sightings.targets_per_photo())


def _by_target(target: Index, chosen: Mask) -> Iterator[tuple[int, Index]]:
    """Rows of the chosen sightings of each target."""
    rows = np.flatnonzero(chosen)
    rows = rows[np.argsort(target[rows], kind="stable")]
    for group in np.split(rows, np.flatnonzero(np.diff(target[rows])) + 1):
        if len(group) >= 2 * FEWEST_OF_PLACE:
            yield int(target[group[0]]), group


def _split(target: int, views: _Views, options: SplitOptions) -> SplitTarget | None:
    every = np.ones(len(views.squares), dtype=np.bool_)
    one_place = views.after(views.step(every)).sum()
    limit = options.least_sigmas**2
    if one_place < limit * views.numbers.sum():
        return None
    best: SplitTarget | None = None
    for first in range(len(every)):
        second = _grouped(views, np.arange(len(every)) == first)
        if min(second.sum(), (~second).sum()) < FEWEST_OF_PLACE:
            continue
        steps = [views.step(group) for group in (~second, second)]
        squares = [views.after(step)[group] for step, group in zip(steps, (~second, second), strict=True)]
        fits = all(
            own.sum() < limit * views.numbers[group].sum()
            for own, group in zip(squares, (~second, second), strict=True)
        )
        two_places = squares[0].sum() + squares[1].sum()
        gain = float(one_place - two_places)
        if fits and one_place > options.least_fall * two_places and (best is None or gain > best.gain):
            best = SplitTarget(target, float(np.linalg.norm((steps[0] - steps[1])[:3])), gain)
    return best


def _grouped(views: _Views, second: Mask) -> Mask:
    """Which sightings belong to the second place, each to the one that it fits better; begun with some."""
    for _ in range(GROUPINGS):
        nearer = views.after(views.step(second)) < views.after(views.step(~second))
        if not nearer.any() or nearer.all() or (nearer == second).all():
            break
        second = nearer
    return second


def _surest_around(found: list[SplitTarget], problem: BundleProblem) -> tuple[SplitTarget, ...]:
    """Those of greatest gain among all that any of their photographs shows: what has moved drags others along."""
    sightings = problem.sightings
    gain = np.zeros(sightings.target_count)
    gain[[one.target for one in found]] = [one.gain for one in found]
    around = np.zeros(sightings.photo_count)
    np.maximum.at(around, sightings.photo, gain[sightings.target])
    greatest = np.zeros(sightings.target_count)
    np.maximum.at(greatest, sightings.target, around[sightings.photo])
    return tuple(one for one in found if one.gain >= greatest[one.target])
