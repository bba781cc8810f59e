"""What the planner says of dots beside what the detector says: ``python -m benchmarks.dot_errors``.

Rooms are rendered in three lights with plates of three sizes. By the lesser semi-axis of the dots: the standard
deviation of a circle of 1 px that the detector's covariances mean, along the two axes in which the planner's rim sum is
round, and the planner's own. Constants of ``DotErrorOptions`` are read off here.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from app.geometry.observations import TargetObservation
from app.planning.dot_errors import LIGHTS, DotErrorOptions, Light, dot_information
from app.planning.imaging import ImagingOptions
from app.planning.posting import RoomOptions
from app.planning.room import build_room
from app.planning.sight import SeenTarget
from app.planning.survey_plan import StationOptions, phone_camera, plan_stations
from app.planning.synthetic import render
from app.targets.family import family_by_name
from app.targets.layout import dot_centres_u
from app.vision.detector import detect
from app.vision.photo import load_photo

FAMILY = "golay"
IMAGING: dict[Light, ImagingOptions] = {
    "bright": ImagingOptions(),
    "indoor": ImagingOptions(full_well_electrons=1000.0, lens_sigma_px=0.7),
    "dim": ImagingOptions(full_well_electrons=300.0, exposure_ev=-1.0, lens_sigma_px=0.8, jpeg_quality=88),
}
ROOMS = ((0.014, (9.0, 7.0, 2.6)), (0.02, (6.0, 5.0, 2.6)), (0.03, (6.0, 5.0, 2.6)))
SIZE_PX, TARGETS = (1920, 1080), 60
EDGES_PX = (0.0, 1.2, 1.6, 2.0, 2.5, 3.0, 3.5, 4.5, 6.0, 9.0, 14.0, np.inf)
FEWEST = 6  # plates that make a row
UNSCALED = DotErrorOptions(bright=1.0, indoor=1.0, dim=1.0, blur_px=1e-9)


def main() -> int:
    """Render, detect, compare."""
    parser = argparse.ArgumentParser(prog="dot_errors", description=__doc__)
    parser.add_argument("--photos", type=int, default=5, help="of each room in each light")
    parser.add_argument("--seed", type=int, default=31)
    arguments = parser.parse_args()
    print("light   semi-axis px  plates  detector px (two axes)  planner px")
    for light in LIGHTS:
        rows = np.array(list(_plates(light, arguments.photos, arguments.seed)))
        for least, below in pairwise(EDGES_PX):
            chosen = rows[(rows[:, 0] >= least) & (rows[:, 0] < below)]
            if len(chosen) >= FEWEST:
                detector = chosen[:, 1:3].mean(axis=0) ** -0.5
                planner = chosen[:, 3].mean() ** -0.5
                span = f"{least:4g} to {below:4g}"
                print(f"{light:7s} {span:12s} {len(chosen):7d} {detector[1]:11.3f} {detector[0]:6.3f} {planner:15.3f}")
    return 0


def _plates(light: Light, photos: int, seed: int) -> Iterator[tuple[float, float, float, float]]:
    """Lesser semi-axis, px, and information on a circle of 1 px: the detector's along two axes, the planner's."""
    family, camera = family_by_name(FAMILY), phone_camera(*SIZE_PX)
    for u_m, size_m in ROOMS:
        scene = build_room(RoomOptions(size_m, TARGETS, u_m=u_m), family, seed)
        for index, station in enumerate(plan_stations(size_m, StationOptions(count=photos), seed)):
            photo = render(scene, camera, station, IMAGING[light], seed + index)
            found = {target.code: target for target in detect(load_photo(photo.jpeg).bgr, family).targets}
            whole = (seen for seen in photo.targets if seen.whole and not seen.wrong and seen.code in found)
            yield from (_compare(seen, found[seen.code], light) for seen in whole)


def _compare(seen: SeenTarget, target: TargetObservation, light: Light) -> tuple[float, float, float, float]:
    plane = np.column_stack([np.ones(len(seen.dots_px)), dot_centres_u()])
    px_by_u = np.asarray(np.linalg.lstsq(plane, seen.dots_px, rcond=None)[0][1:].T, dtype=np.float64)
    said = np.linalg.inv(target.covariances_px2[target.measured]).mean(axis=0)
    rim = np.linalg.inv(np.linalg.cholesky(dot_information(px_by_u, light, UNSCALED)))
    low, high = np.linalg.eigvalsh(rim @ said @ rim.T)
    planned = np.trace(rim @ dot_information(px_by_u, light) @ rim.T) / 2.0
    return float(np.linalg.svd(px_by_u)[1][1]), float(low), float(high), float(planned)


if __name__ == "__main__":
    sys.exit(main())
