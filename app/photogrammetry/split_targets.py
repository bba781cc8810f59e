"""Targets that moved by too little for single sightings to be false, but whose sightings fall into two groups.

A target that was moved between photographs stands in two places, and the adjustment puts it between them. Each sighting
is then off by half of the way, which may be less than what calls a sighting false; all of them together tell. A group's
step against the others is tested with its full covariance (Baarda's test of several dimensions; Teunissen, Testing
theory, 2006, chapter 4): chance, photographs that follow, and lenses that breathe.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import chdtri, chndtrinc

from app.photogrammetry.network import POSE_COUNT
from app.photogrammetry.sightings import Sightings
from app.photogrammetry.target_pulls import TargetPulls

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class SplitOptions:
    """When a target stands in two places.

    Attributes
    ----------
    false_alarms : float
        Targets of a survey that chance alone names, where residuals are chance: one in so many surveys at most, by
        Bonferroni's bound over all targets and all groupings of their sightings.
    lens_factor : float
        Times that limit of chance, for what lenses leave that neither a polynomial nor the photographs' scatter
        describes; what is still named falsely is measured by ``python -m benchmarks.moved_plates --only calm``.
    chance_beside : float
        With this probability chance alone makes a target contradict itself so much beside its two places that the limit
        grows, as it does for plates that are not as printed.
    power : float
        Of targets moved as far as is called detectable this share is found at least.
    most_rounds : int
        Adjustments in which the worst target around is left out.
    """

    false_alarms: float = 0.01
    lens_factor: float = 2.0
    chance_beside: float = 0.001
    power: float = 0.8
    most_rounds: int = 5

    def limit(self, sightings: int, targets: int) -> float:
        """Weighted squares that two places must explain, of a target with so many sightings among so many targets."""
        groupings = 2.0 ** (sightings - 1)
        return self.lens_factor * float(chdtri(POSE_COUNT, self.false_alarms / (targets * groupings)))

    def beside(self, squares: float, freedom: int) -> float:
        """Factor of the limit for what contradicts itself beside the two places."""
        return max(1.0, squares / float(chdtri(freedom, self.chance_beside)))

    def found_from(self, sightings: int, targets: int) -> float:
        """Non-centrality from which that limit is passed with the power."""
        return float(chndtrinc(self.limit(sightings, targets), POSE_COUNT, 1.0 - self.power))


@dataclass(frozen=True)
class SplitTarget:
    """A target in two places.

    Attributes
    ----------
    target : int
    apart_m : float
    gain : float
        What they explain of its squares, in variances.
    lone : int or None
        The one sighting that shows the target elsewhere, when it is only one: false rather than moved.
    """

    target: int
    apart_m: float
    gain: float
    lone: int | None


def split_of(pulls: TargetPulls, target_count: int, options: SplitOptions) -> SplitTarget | None:
    """The two places, if one is only for one photograph, of one target among so many; None where it stands in one."""
    limit = options.limit(len(pulls.rows), target_count)
    # No grouping explains more than all there is.
    if pulls.squares <= limit:
        return None
    split = _Groups(pulls).best()
    beside = options.beside(pulls.squares - split.gain, pulls.freedom - POSE_COUNT)
    return split if split.gain > limit * beside else None


@dataclass(frozen=True)
class _Groups:
    """Groupings of one target's n sightings; a group is a mask (n,), many are (k, n)."""

    pulls: TargetPulls

    def gains(self, groups: Mask) -> Array:
        """What a step of each group against the others explains, shape (k,); 0 where there are no others."""
        possible = groups.any(axis=1) & ~groups.all(axis=1)
        pulls, information = self._summed(groups[possible])
        gains = np.zeros(len(groups))
        gains[possible] = (pulls * np.linalg.solve(information, pulls[..., None])[..., 0]).sum(axis=-1)
        return gains

    def _summed(self, groups: Mask) -> tuple[Array, Array]:
        members = groups.astype(np.float64)
        across = np.tensordot(members, self.pulls.information, axes=1)
        return members @ self.pulls.pulls, np.einsum("kisj,ks->kij", across, members)

    def best(self) -> SplitTarget:
        """The grouping that explains most, from runs in the order of the photographs and from single ones."""
        count = len(self.pulls.rows)
        starts = np.concatenate([np.tri(count, dtype=np.bool_)[:-1], np.eye(count, dtype=np.bool_)])
        group, gain = max((self._improved(start) for start in starts), key=lambda found: found[1])
        pulls, information = self._summed(group[None])
        step = np.linalg.solve(information[0], pulls[0])
        smaller = group if 2 * group.sum() <= count else ~group
        lone = int(self.pulls.rows[smaller][0]) if smaller.sum() == 1 else None
        return SplitTarget(self.pulls.target, float(np.linalg.norm(step[:3])), gain, lone)

    def _improved(self, group: Mask) -> tuple[Mask, float]:
        """The grouping with single sightings changed over, as long as that explains more; and what it explains."""
        gain, single = float(self.gains(group[None])[0]), np.eye(len(group), dtype=np.bool_)
        while True:
            others = group ^ single
            gains = self.gains(others)
            best = int(gains.argmax())
            if gains[best] <= gain:
                return group, gain
            group, gain = others[best], float(gains[best])


def surest_around(found: Sequence[SplitTarget], sightings: Sightings) -> tuple[SplitTarget, ...]:
    """Those of greatest gain among all that any of their photographs shows: what has moved drags others along."""
    gain = np.zeros(sightings.target_count)
    gain[[one.target for one in found]] = [one.gain for one in found]
    around = np.zeros(sightings.photo_count)
    np.maximum.at(around, sightings.photo, gain[sightings.target])
    greatest = np.zeros(sightings.target_count)
    np.maximum.at(greatest, sightings.target, around[sightings.photo])
    return tuple(one for one in found if one.gain >= greatest[one.target])
