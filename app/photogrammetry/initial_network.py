"""The initial network: from unordered photographs to approximate poses of all that hangs together.

It starts from the best-connected pair, orients the photographs that know most of what stands, places what they see,
adjusts, and goes on until no photograph can be added. What remains may form a network of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.free_adjustment import adjust_growth
from app.photogrammetry.growth import Growth, GrowthOptions, seeded
from app.photogrammetry.local_adjustment import adjust_locally
from app.photogrammetry.orient_photos import orient_photos
from app.photogrammetry.place_targets import place_targets
from app.photogrammetry.sightings import Sightings

Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

OnGrowth = Callable[[int], None]

LEAST_WAVE_SHARE = 0.5  # of the best-informed photograph's known targets; who knows less waits for more
ENOUGH_SURE = 4  # decided targets that leave a photograph no other pose: three stand in a row too often
SMALLEST_NETWORK = 2  # photographs: one alone intersects nothing


def grow_networks(problem: BundleProblem, options: GrowthOptions, on_growth: OnGrowth) -> tuple[Growth, ...]:
    """All networks that the photographs form, each in a frame of its own, in the order they were grown.

    Parameters
    ----------
    problem : BundleProblem
        Without known poses or control points.
    options : GrowthOptions
    on_growth : callable
        Told after each wave how many photographs stand; may raise to stop.
    """
    shared = _shared_targets(problem.sightings)
    free = np.ones(problem.sightings.photo_count, dtype=np.bool_)
    may_seed = free.copy()
    networks: list[Growth] = []
    while (seed := _best_connected(shared, free, may_seed)) is not None:
        grown = _grown(seeded(problem, seed, options), free, partial(_tell, on_growth, int((~free).sum())))
        may_seed[seed] = False
        if grown.oriented.sum() >= SMALLEST_NETWORK:
            networks.append(grown)
            free &= ~grown.oriented
    return tuple(networks)


def _tell(on_growth: OnGrowth, done_before: int, oriented: int) -> None:
    on_growth(done_before + oriented)


def _shared_targets(sightings: Sightings) -> csr_array:
    """How many targets each two photographs share, shape (P, P), zero on the diagonal."""
    ones = np.ones(len(sightings))
    seen = csr_array((ones, (sightings.photo, sightings.target)), (sightings.photo_count, sightings.target_count))
    shared = csr_array(seen @ seen.T)
    shared.setdiag(0)
    shared.eliminate_zeros()
    return shared


def _best_connected(shared: csr_array, free: Mask, may_seed: Mask) -> int | None:
    """Of the pair of free photographs that share most targets, the one that shares more with all others."""
    pairs = shared.tocoo()
    open_pairs = free[pairs.row] & free[pairs.col] & may_seed[pairs.row]
    if not open_pairs.any():
        return None
    count = np.where(open_pairs, pairs.data, 0)
    total = np.asarray(shared @ free.astype(np.float64))
    return int(pairs.row[np.lexsort([-total[pairs.row], -count])[0]])


def _grown(growth: Growth, free: Mask, on_growth: OnGrowth) -> Growth:
    """The growth with every free photograph that can be added."""
    growth = place_targets(growth)
    tried_with = np.zeros(len(free))
    while True:
        wave = _wave(growth, free, tried_with)
        if len(wave):
            before, growth = growth.oriented, orient_photos(growth, wave)
            fresh = np.flatnonzero(growth.oriented & ~before)
            growth = place_targets(growth, fresh)
            if growth.adjusted_photos and len(fresh):
                growth = place_targets(adjust_locally(growth, fresh), fresh)
            on_growth(int(growth.oriented.sum()))
        elif growth.oriented.sum() > max(growth.adjusted_photos, 1):
            tried_with[:] = 0  # better cameras may orient what failed before
        else:
            return growth
        if not len(wave) or growth.oriented.sum() >= growth.options.growth_per_adjustment * growth.adjusted_photos:
            growth = place_targets(adjust_growth(growth))


def _wave(growth: Growth, free: Mask, tried_with: npt.NDArray[np.float64]) -> Index:
    """Photographs to orient next, ascending: those that know most targets, at most as many as stand already.

    Who knows enough targets whose mirror image is ruled out goes before all others: what single photographs have
    placed leans with them.
    """
    sightings = growth.problem.sightings
    known, sure = (
        np.bincount(sightings.photo, stands[sightings.target], minlength=sightings.photo_count)
        for stands in (growth.placed, growth.decided)
    )
    waiting = np.flatnonzero(free & ~growth.oriented & (known > tried_with))
    if not len(waiting):
        return waiting
    well_informed = waiting[sure[waiting] >= ENOUGH_SURE]
    waiting, count = (well_informed, sure) if len(well_informed) else (waiting, known)
    waiting = waiting[np.argsort(-count[waiting], kind="stable")][: int(growth.oriented.sum())]
    wave = np.sort(waiting[count[waiting] >= LEAST_WAVE_SHARE * count[waiting[0]]])
    tried_with[wave] = known[wave]
    return wave
