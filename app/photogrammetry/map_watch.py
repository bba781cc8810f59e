"""What the snapshots of a map tell of it: targets that moved, vanished or came new, and a map that fits no more."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.geometry.target_map import TargetMap
from app.photogrammetry.evidence import SnapshotEvidence
from app.photogrammetry.moved_targets import MovedOptions, find_moved_targets
from app.photogrammetry.places import places_of
from app.photogrammetry.vanished_targets import VanishedOptions, find_vanished_targets

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
FindingKind = Literal["moved-target", "misfit-target", "vanished-target", "unknown-target", "map-misfit"]


@dataclass(frozen=True)
class WatchOptions:
    """When a map's trouble is told.

    Attributes
    ----------
    place_m : float
        Snapshots nearer to each other than this are of one place: a step of a person, a third of it.
    fewest_refused, fewest_unknown : int
        Snapshots that refused a target, that read a code which the map does not hold, before it is told. Both happen
        by chance: one target in 10,000 is refused, a misread code hits another one of the family.
    fewest_places : int
        Places that these snapshots were taken from.
    refused_share : float
        Least share of the snapshots that see a target, since most of them refuse it, that do.
    recent : int
        Newest snapshots that the map as a whole is judged by.
    sigma0_rise : float
        Their median sigma0 over that of the older ones from which the map fits no more.
    greatest_sigma0 : float
        The same without older ones: detectors' own covariances are good to a factor of two.
    inconsistent_share : float
        Share of them in which no majority of targets agreed.
    moved : MovedOptions
    vanished : VanishedOptions
    """

    place_m: float = 0.25
    fewest_refused: int = 6
    fewest_unknown: int = 5
    fewest_places: int = 3
    refused_share: float = 0.5
    recent: int = 20
    sigma0_rise: float = 1.5
    greatest_sigma0: float = 2.5
    inconsistent_share: float = 0.5
    moved: MovedOptions = MovedOptions()
    vanished: VanishedOptions = VanishedOptions()


@dataclass(frozen=True)
class WatchedSnapshot:
    """A snapshot that tells of the map.

    Attributes
    ----------
    captured_s : float
        UTC.
    device_id : str or None
    evidence : SnapshotEvidence or None
        None when its targets agreed on no pose.
    """

    captured_s: float
    device_id: str | None
    evidence: SnapshotEvidence | None


@dataclass(frozen=True)
class Finding:
    """One trouble of a map.

    Attributes
    ----------
    kind : str
        ``moved-target``: stands elsewhere; ``misfit-target``: is refused again and again though its centre stands
        (turned, bent, printed anew); ``vanished-target``: is not seen any more beside its neighbours;
        ``unknown-target``: is read and not in the map; ``map-misfit``: the poses as a whole fit worse than they did.
    code : int or None
        None when it is about the map.
    since_s, last_s : float
        First and last snapshot that tell of it.
    snapshots, places, devices : int
        How many tell of it, from how many places, taken by how many devices.
    displacement_m : ndarray of shape (3,) or None
        Of the target's centre, site axes.
    covariance_m2 : ndarray of shape (3, 3) or None
    excess : float or None
        Chi-square of the displacement over the limit of the test, or median sigma0 over its limit.
    """

    kind: FindingKind
    code: int | None
    since_s: float
    last_s: float
    snapshots: int
    places: int
    devices: int
    displacement_m: Array | None = None
    covariance_m2: Array | None = None
    excess: float | None = None


def watch_map(
    snapshots: Sequence[WatchedSnapshot], target_map: TargetMap, options: WatchOptions | None = None
) -> tuple[Finding, ...]:
    """All that the snapshots of a map tell of it.

    Parameters
    ----------
    snapshots : sequence of WatchedSnapshot
        Resected in this map, in any order.
    target_map : TargetMap
    options : WatchOptions, optional
    """
    in_order = sorted(snapshots, key=lambda snapshot: snapshot.captured_s)
    watch = _Watch(in_order, target_map, options or WatchOptions())
    moved = tuple(watch.moved())
    known = {finding.code for finding in moved}
    return (*moved, *watch.misfits(known), *watch.vanished(), *watch.unknown(), *watch.whole())


class _Watch:
    """Snapshots in the order of time; those with a pose, and the places that they were taken from."""

    def __init__(self, snapshots: Sequence[WatchedSnapshot], target_map: TargetMap, options: WatchOptions) -> None:
        self._all = snapshots
        self._map = target_map
        self._options = options
        self._located = [snapshot for snapshot in snapshots if snapshot.evidence is not None]
        self._evidence = [snapshot.evidence for snapshot in snapshots if snapshot.evidence is not None]
        positions_m = np.array([evidence.site_from_cam.position_m for evidence in self._evidence]).reshape(-1, 3)
        self._places = places_of(positions_m, options.place_m)

    def moved(self) -> Iterator[Finding]:
        """Targets that stand elsewhere."""
        for target in find_moved_targets(self._evidence, self._places, self._map, self._options.moved):
            found = target.displacement
            yield self._finding(
                "moved-target", target.code, target.rows, (found.value_m, found.covariance_m2, found.excess)
            )

    def misfits(self, moved: set[int | None]) -> Iterator[Finding]:
        """Targets that are refused again and again."""

        def refused(evidence: SnapshotEvidence) -> list[int]:
            movements = evidence.movements
            return [code for code in movements.codes[~movements.used].tolist() if code not in moved]

        for code in self._by_code(refused):
            rows, share = self._refused_since(code)
            often = len(rows) >= self._options.fewest_refused and share >= self._options.refused_share
            if often and self._stands(rows) >= self._options.fewest_places:
                yield self._finding("misfit-target", code, rows)

    def _refused_since(self, code: int) -> tuple[Index, float]:
        """Snapshots that refuse a target since most do, and which share of all that see it they are."""
        seen = self._by_code(lambda evidence: evidence.movements.codes.tolist())[code]
        movements = [self._evidence[row].movements for row in seen]
        refused = np.array([not found.used[found.codes == code][0] for found in movements])
        balance = np.cumsum(np.where(refused, 1.0, -1.0)[::-1])
        first = len(seen) - 1 - int(np.argmax(balance))
        return seen[first:][refused[first:]], float(refused[first:].mean())

    def vanished(self) -> Iterator[Finding]:
        """Targets that are not seen any more."""
        for target in find_vanished_targets(self._evidence, self._places, self._map, self._options.vanished):
            yield self._finding("vanished-target", target.code, target.rows)

    def unknown(self) -> Iterator[Finding]:
        """Codes that the map does not hold."""
        for code, rows in self._by_code(lambda evidence: list(evidence.unknown_codes)).items():
            if len(rows) >= self._options.fewest_unknown and self._stands(rows) >= self._options.fewest_places:
                yield self._finding("unknown-target", code, rows)

    def whole(self) -> Iterator[Finding]:
        """The map itself."""
        options = self._options
        recent = self._all[-options.recent :]
        if len(recent) < options.recent:
            return
        without_pose = sum(snapshot.evidence is None for snapshot in recent)
        located = np.arange(len(self._located) - (len(recent) - without_pose), len(self._located))
        excess = self._sigma0_excess(located)
        stands = self._stands(located)
        many_refused = without_pose >= options.inconsistent_share * len(recent)
        if many_refused or (excess > 1.0 and stands >= options.fewest_places):
            devices = len({snapshot.device_id for snapshot in recent})
            span_s = (recent[0].captured_s, recent[-1].captured_s)
            yield Finding("map-misfit", None, *span_s, len(recent), stands, devices, excess=excess)

    def _sigma0_excess(self, located: Index) -> float:
        """Median sigma0 of the newest located snapshots over the limit; 0 without any."""
        options = self._options
        if not len(located):
            return 0.0
        sigma0 = np.array([evidence.sigma0 for evidence in self._evidence])
        older = sigma0[: located[0]]
        calm = len(older) >= options.recent
        limit = options.sigma0_rise * max(1.0, float(np.median(older))) if calm else options.greatest_sigma0
        return float(np.median(sigma0[located[0] :])) / limit

    def _by_code(self, codes_of: Callable[[SnapshotEvidence], list[int]]) -> dict[int, Index]:
        """Numbers of the snapshots that tell something of a code."""
        rows: dict[int, list[int]] = {}
        for row, evidence in enumerate(self._evidence):
            for code in codes_of(evidence):
                rows.setdefault(code, []).append(row)
        return {code: np.array(found, dtype=np.intp) for code, found in sorted(rows.items())}

    def _stands(self, rows: Index) -> int:
        return len(np.unique(self._places[rows]))

    def _finding(
        self, kind: FindingKind, code: int, rows: Index, displacement: tuple[Array, Array, float] | None = None
    ) -> Finding:
        told = [self._located[row] for row in rows]
        moved = (None, None, None) if displacement is None else displacement
        devices = len({snapshot.device_id for snapshot in told})
        span_s = (told[0].captured_s, told[-1].captured_s)
        return Finding(kind, code, *span_s, len(rows), self._stands(rows), devices, *moved)
