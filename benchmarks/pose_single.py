"""One target in view, by distance and incidence: ``python -m benchmarks.pose_single``.

A plate is seen in the middle of the picture, at 0 to 60 degrees; dots, map and camera are redrawn. The table gives how
many redraws are located, the mean normalised error squared of these (6 when honest), and how many lie beyond what a
chi-square of six exceeds once in 10,000 (a mirrored pose does, by far).
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace

import numpy as np
from scipy.special import chdtri

from app.errors import NotLocated
from app.geometry.target_map import MappedTarget
from app.photogrammetry.resection import resect
from app.planning.posting import pose_facing
from app.targets.layout import DEFAULT_U_M, dots_target_m
from benchmarks.pose_scene import View, ViewOptions, draw, make_view, pose_error

DISTANCES_M = (0.5, 1.0, 1.5, 2.0, 3.0, 5.0)
INCIDENCES_DEG = (0.0, 10.0, 20.0, 40.0, 60.0)
WRONG = float(chdtri(6, 1e-4))


def main() -> int:
    """Redraw, locate, print."""
    parser = argparse.ArgumentParser(prog="pose_single", description=__doc__)
    parser.add_argument("--draws", type=int, default=100)
    draws = parser.parse_args().draws
    print("distance  incidence   located     NEES   beyond 1e-4")
    located, beyond = 0, 0
    for distance_m in DISTANCES_M:
        for incidence_deg in INCIDENCES_DEG:
            nees = _errors(_view(distance_m, np.radians(incidence_deg)), draws)
            wrong = sum(error > WRONG for error in nees)
            mean = f"{np.mean(nees):8.2f}" if nees else "       -"
            share = 100.0 * len(nees) / draws
            print(f"{distance_m:6.1f} m {incidence_deg:6.0f} deg {share:7.0f} % {mean} {wrong:8d}", flush=True)
            located, beyond = located + len(nees), beyond + wrong
    print(f"of {located} located {beyond} lie beyond what chance exceeds once in 10,000")
    return 0


def _view(distance_m: float, incidence_rad: float) -> View:
    """A plate straight ahead, turned about the camera's upright axis and hung a little askew."""
    view = make_view(ViewOptions(targets=1, distance_m=distance_m), seed=1)
    right, down, ahead = view.site_from_cam.rotation.T
    normal = np.sin(incidence_rad) * right - np.cos(incidence_rad) * ahead
    at_m = view.site_from_cam.position_m + distance_m * ahead
    pose = pose_facing(normal, -down, at_m, roll_rad=0.2)
    covariance = view.target_map.targets[0].covariance
    target = MappedTarget(1, pose, pose.apply(dots_target_m(DEFAULT_U_M)), covariance, rays=9, rms_px=0.1)
    return replace(view, target_map=replace(view.target_map, targets=(target,)))


def _errors(view: View, draws: int) -> list[float]:
    """Normalised errors squared of the located redraws."""
    rng, found = np.random.default_rng(3), []
    for _ in range(draws):
        try:
            located = resect(*draw(view, rng))
        except NotLocated:
            continue
        error = pose_error(located.site_from_cam, view.site_from_cam)
        found.append(float(error @ np.linalg.solve(located.covariance, error)))
    return found


if __name__ == "__main__":
    sys.exit(main())
