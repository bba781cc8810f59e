"""One target of a few displaced: how far it moves the pose, in its own sigmas: ``python -m benchmarks.pose_displaced``.

Each redrawn photograph is located twice, with the map as it is and with one target of it displaced in a random
direction; the shift of the position between the two is held against the standard deviation (3-D) that the second one
claims. Beside it stands the test alone (no doubt), and a pose that is refused moves nobody.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated
from app.geometry.target_map import TargetMap
from app.photogrammetry.resection import ResectionOptions, resect
from app.photogrammetry.resection_doubt import DoubtOptions
from benchmarks.pose_scene import View, ViewOptions, draw, make_view, moved, pose_error

Array = npt.NDArray[np.float64]

MM_PER_M = 1000.0
TARGETS = (3, 4, 5, 10)
DISPLACEMENTS_MM = (0.0, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 200.0)
NEVER = 10**6
WAYS = {
    "test alone": replace(ResectionOptions(), doubt=DoubtOptions(fewest_targets=NEVER)),
    "with doubt": ResectionOptions(),
}


@dataclass(frozen=True)
class Tally:
    """Shifts over sigmas and normalised errors squared of the located, and how many were refused."""

    shifts: list[float] = field(default_factory=list)
    nees: list[float] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)

    def line(self) -> str:
        """Its figures as one row."""
        if not self.shifts:
            return "all refused"
        shifts = np.array(self.shifts)
        rms, high = np.sqrt(np.square(shifts).mean()), np.quantile(shifts, 0.95)
        total = len(shifts) + len(self.refused)
        return f"{rms:8.2f} {high:8.2f} {np.mean(self.nees):8.2f} {100.0 * len(self.refused) / total:8.1f} %"


def main() -> int:
    """Displace, locate, print."""
    parser = argparse.ArgumentParser(prog="pose_displaced", description=__doc__)
    parser.add_argument("--views", type=int, default=100)
    parser.add_argument("--draws", type=int, default=3)
    parser.add_argument("--targets", type=int, nargs="+", default=TARGETS)
    arguments = parser.parse_args()
    print("targets  displaced by              shift/sigma rms    95 %     NEES  refused")
    for targets in arguments.targets:
        for millimetres in DISPLACEMENTS_MM:
            tallies = {name: Tally() for name in WAYS}
            for seed in range(arguments.views):
                view, rng = make_view(ViewOptions(targets=targets), seed), np.random.default_rng([1, seed])
                for _ in range(arguments.draws):
                    _locate_both(view, millimetres / MM_PER_M, rng, tallies)
            for name, tally in tallies.items():
                print(f"{targets:7d} {millimetres:9.0f} mm  {name:14s} {tally.line()}", flush=True)
    return 0


def _locate_both(view: View, distance_m: float, rng: np.random.Generator, tallies: dict[str, Tally]) -> None:
    observations, target_map, camera = draw(view, rng)
    displaced = _displaced(target_map, distance_m, rng)
    for name, options in WAYS.items():
        try:
            before = resect(observations, target_map, camera, options)
            after = resect(observations, displaced, camera, options)
        except NotLocated as refusal:
            tallies[name].refused.append(str(refusal.fields["reason"]))
            continue
        shift_m = after.site_from_cam.position_m - before.site_from_cam.position_m
        error = pose_error(after.site_from_cam, view.site_from_cam)
        tallies[name].shifts.append(float(np.linalg.norm(shift_m) / np.sqrt(np.trace(after.covariance[:3, :3]))))
        tallies[name].nees.append(float(error @ np.linalg.solve(after.covariance, error)))


def _displaced(target_map: TargetMap, distance_m: float, rng: np.random.Generator) -> TargetMap:
    direction, which = rng.normal(size=3), int(rng.integers(len(target_map.targets)))
    movement = np.zeros(6)
    movement[:3] = distance_m * direction / np.linalg.norm(direction)
    targets = list(target_map.targets)
    targets[which] = moved(targets[which], movement)
    return replace(target_map, targets=tuple(targets))


if __name__ == "__main__":
    sys.exit(main())
