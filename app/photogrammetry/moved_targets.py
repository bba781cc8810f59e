"""Which targets stand elsewhere than the map says: the surest first, each held against those that are in no doubt.

A target that moved drags the poses that it carries, so that its neighbours seem to move as well. So the surest is taken
out of all poses before the next is looked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.special import chdtri

from app.geometry.target_map import TargetMap
from app.photogrammetry.displacement_test import (
    FREEDOM,
    Displacement,
    DisplacementOptions,
    Sightings,
    find_displacement,
    mean_chi2,
)
from app.photogrammetry.evidence import SnapshotEvidence
from app.photogrammetry.relative_movements import hold_against_others

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


@dataclass(frozen=True)
class MovedOptions:
    """How moved targets are looked for.

    Attributes
    ----------
    fewest_others : int
        Targets beside the one in question that a pose hangs on: among four, three outvote one.
    map_floor_m : float
        What a map errs by beside what its covariances say, each coordinate: a bent wall, paper that swells. Two tenths
        of a millimetre are what maps of rendered rooms leave in shape; three leave room.
    scale_targets : int
        Targets from which their own scatter is estimated; with fewer, covariances are taken at their word.
    max_scale : float
        Greatest factor by which that scatter widens variances.
    most_moved : int
        After so many the map as a whole is out of date.
    displacement : DisplacementOptions
    """

    fewest_others: int = 3
    map_floor_m: float = 3e-4
    scale_targets: int = 8
    max_scale: float = 9.0
    most_moved: int = 50
    displacement: DisplacementOptions = DisplacementOptions()


@dataclass(frozen=True)
class MovedTarget:
    """A target that stands elsewhere.

    Attributes
    ----------
    code : int
    displacement : Displacement
    rows : ndarray of shape (N,), int
        Numbers of the snapshots since it moved that tell of it.
    """

    code: int
    displacement: Displacement
    rows: Index


@dataclass
class _Watch:
    """Snapshots in the order of time, and from which on a target's word does not count any more."""

    snapshots: Sequence[SnapshotEvidence]
    places: Index
    target_map: TargetMap
    options: MovedOptions
    moved: dict[int, MovedTarget] = field(default_factory=dict)
    held: dict[int, dict[int, tuple[Array, Array]]] = field(default_factory=dict)

    def hold(self, rows: Sequence[int]) -> None:
        """Hold the targets of some snapshots against each other, anew."""
        for row in rows:
            evidence = self.snapshots[row]
            codes = evidence.movements.codes.tolist()
            mapped = [self.target_map.by_code[code] for code in codes]
            trusted = evidence.movements.used & np.array([not self._is_doubted(code, row) for code in codes])
            relative = hold_against_others(
                evidence,
                np.array([target.site_from_target.position_m for target in mapped]).reshape(-1, 3),
                np.array([target.covariance for target in mapped]).reshape(-1, 6, 6),
                trusted,
                self.options.fewest_others,
            )
            for code, value_m, covariance_m2 in zip(
                codes, relative.displacements_m, relative.covariances_m2, strict=True
            ):
                seen = self.held.setdefault(code, {})
                seen.pop(row, None)
                if np.isfinite(value_m).all():
                    seen[row] = value_m, covariance_m2

    def _is_doubted(self, code: int, row: int) -> bool:
        return code in self.moved and row >= self.moved[code].rows[0]

    def rows_of(self, code: int) -> Index:
        """Snapshots that tell of a target."""
        return np.array(sorted(self.held.get(code, {})), dtype=np.intp)

    def sightings(self, code: int) -> Sightings:
        """What they tell."""
        rows, seen = self.rows_of(code), self.held[code]
        values_m = np.array([seen[row][0] for row in rows])
        return Sightings(values_m, np.linalg.inv(np.array([seen[row][1] for row in rows])), self.places[rows])

    def shared_m2(self, code: int) -> Array:
        """What errs alike in all sightings of a target."""
        own_m2 = self.target_map.by_code[code].covariance[:FREEDOM, :FREEDOM]
        return self.scale * (own_m2 + self.options.map_floor_m**2 * np.eye(FREEDOM))

    @cached_property
    def scale(self) -> float:
        """How much more than that the targets scatter, by their median."""
        fewest = self.options.displacement.fewest_snapshots
        often = [code for code, seen in self.held.items() if len(seen) >= fewest]
        if len(often) < self.options.scale_targets:
            return 1.0
        floor_m2 = self.options.map_floor_m**2 * np.eye(FREEDOM)
        chi2 = [
            mean_chi2(
                self.sightings(code),
                self.target_map.by_code[code].covariance[:FREEDOM, :FREEDOM] + floor_m2,
                self.options.displacement,
            )
            for code in often
        ]
        return float(np.clip(np.median(chi2) / chdtri(FREEDOM, 0.5), 1.0, self.options.max_scale))

    def test(self, code: int) -> MovedTarget | None:
        """Whether a target moved."""
        rows = self.rows_of(code)
        if len(rows) < self.options.displacement.fewest_snapshots:
            return None
        found = find_displacement(self.sightings(code), self.shared_m2(code), self.options.displacement)
        return None if found is None else MovedTarget(code, found, rows[found.first :])


def find_moved_targets(
    snapshots: Sequence[SnapshotEvidence], places: Index, target_map: TargetMap, options: MovedOptions | None = None
) -> tuple[MovedTarget, ...]:
    """Targets that stand elsewhere than the map says.

    Parameters
    ----------
    snapshots : sequence of SnapshotEvidence
        In the order of time, all resected in this map.
    places : ndarray of shape (N,), int
        From which place each was taken.
    target_map : TargetMap
    options : MovedOptions, optional

    Returns
    -------
    tuple of MovedTarget
        The surest first.
    """
    watch = _Watch(snapshots, places, target_map, options or MovedOptions())
    watch.hold(range(len(snapshots)))
    candidates = {code: found for code in sorted(watch.held) if (found := watch.test(code)) is not None}
    while candidates and len(watch.moved) < watch.options.most_moved:
        surest = max(candidates.values(), key=lambda found: found.displacement.excess)
        watch.moved[surest.code] = surest
        touched = [row for row in range(len(snapshots)) if surest.code in snapshots[row].seen_codes]
        watch.hold(touched)
        affected = {code for row in touched for code in snapshots[row].movements.codes.tolist()}
        for code in affected - watch.moved.keys():
            candidates.pop(code, None)
            if (found := watch.test(code)) is not None:
                candidates[code] = found
        candidates.pop(surest.code, None)
    final = (watch.test(code) for code in watch.moved)
    return tuple(sorted((item for item in final if item is not None), key=lambda item: -item.displacement.excess))
