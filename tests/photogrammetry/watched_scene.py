"""Synthetic evidence: a wall of plates seen from many places, resected as it is in the service."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from app.geometry.observations import TargetObservation
from app.geometry.target_map import TargetMap
from app.photogrammetry.evidence import gather_evidence
from app.photogrammetry.map_watch import WatchedSnapshot
from app.photogrammetry.resection import resect
from tests.photogrammetry.resection_scene import (
    Scene,
    calibrated,
    displaced,
    is_in_view,
    looking,
    map_of,
    observe,
    plate,
)

CODES = tuple(range(1, 13))
MOVED = 6


def wall(rng: np.random.Generator) -> TargetMap:
    """Twelve plates on a wall and before it, three rows high."""
    return map_of(
        [
            plate(
                code,
                [0.6 * (code % 4) + 3.0, 6.0 - 0.3 * (code % 3), 0.8 + 0.5 * (code // 4)],
                roll_rad=rng.normal(0, 0.2),
            )
            for code in CODES
        ]
    )


def snapshot(
    believed: TargetMap,
    real: TargetMap,
    rng: np.random.Generator,
    time_s: float,
    misread: Mapping[int, int] | None = None,
) -> WatchedSnapshot:
    """A snapshot from somewhere in the room of the real plates, resected in the map that is believed."""
    eye_m = rng.uniform([2.5, 1.5, 1.2], [5.5, 3.5, 1.8])
    pose = looking(eye_m.tolist(), [rng.uniform(3.5, 4.5), 6.0, 1.4], rng.normal(0, 0.1))
    seen = [target for target in real.targets if is_in_view(target, pose)]
    observations = [_renamed(item, misread or {}) for item in observe(Scene(pose, map_of(seen), calibrated()), rng)]
    resection = resect(observations, believed, calibrated())
    return WatchedSnapshot(time_s, "phone", gather_evidence(observations, believed, resection))


def snapshots(
    believed: TargetMap, real: TargetMap, rng: np.random.Generator, times_s: Sequence[int]
) -> list[WatchedSnapshot]:
    """Many of them."""
    return [snapshot(believed, real, rng, float(time_s)) for time_s in times_s]


def with_displaced(target_map: TargetMap, code: int, shift_m: Sequence[float]) -> TargetMap:
    """The map with one target elsewhere."""
    targets = tuple(
        displaced(target, np.array(shift_m), np.zeros(3)) if target.code == code else target
        for target in target_map.targets
    )
    return replace(target_map, targets=targets)


def without(target_map: TargetMap, code: int) -> TargetMap:
    """The map without one target."""
    return replace(target_map, targets=tuple(target for target in target_map.targets if target.code != code))


def _renamed(seen: TargetObservation, misread: Mapping[int, int]) -> TargetObservation:
    return replace(seen, code=misread.get(seen.code, seen.code))
