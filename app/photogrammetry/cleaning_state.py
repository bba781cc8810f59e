"""A network on its way to being clean: what is still in it, and what was left out for which reason."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.photogrammetry.growth import Growth
from app.photogrammetry.sightings import Sightings

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


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
class CleaningState:
    """A network on its way to being clean.

    Attributes
    ----------
    growth : Growth
        Without what is left out.
    every : Sightings
        All M that it began with.
    false : ndarray of shape (M,), bool
    sigmas : ndarray of shape (M,)
        Root mean square residual of those that were called false, when they were, in standard deviations.
    looked : ndarray of shape (P,), bool
        Photographs that were oriented anew, or that this was tried with.
    targets : tuple of LeftOut
    photos : tuple of int
        Photographs that are left out.
    """

    growth: Growth
    every: Sightings
    false: Mask
    sigmas: Array
    looked: Mask
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

    def reduced(self) -> CleaningState:
        """The state with its network deprived of what is left out."""
        oriented = self.growth.oriented.copy()
        oriented[list(self.photos)] = False
        problem = self.growth.problem.with_sightings(self.every.select(self.kept))
        return replace(self, growth=replace(self.growth, problem=problem, oriented=oriented))


def untouched(growth: Growth) -> CleaningState:
    """A grown network of which nothing is left out yet."""
    every = growth.problem.sightings
    nothing = np.zeros(len(every), dtype=np.bool_)
    return CleaningState(growth, every, nothing, np.zeros(len(every)), np.zeros(every.photo_count, dtype=np.bool_))
