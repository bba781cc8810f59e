"""Milliseconds from detections to a pose, without pixels: ``python -m benchmarks.speed_resection ROOM``.

Each snapshot is detected once; then its resection, what it tells of the map and what a movement would cost are timed
again and again on one thread, by the processor's time. The least of the repeats counts: the rest is other programs'.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
from threadpoolctl import threadpool_limits

from app.cli.arguments import FAMILIES, at_least_one
from app.cli.locate_photo import detect_in_map, known_cameras, resect_in_map
from app.cli.room import open_room
from app.errors import NotLocated, ScattermarkError
from app.geometry.map_file import MapFile
from app.photogrammetry.evidence import gather_evidence
from app.services.best_pose import rolling_shutter_of
from app.services.choose_camera import KnownCameras
from app.vision.photo import load_photo
from benchmarks.output import print_table
from benchmarks.speed import build_content

MS_PER_S = 1000.0
VIEWS = ((1, 40), (41, 100), (101, 10**6))  # targets found


@dataclass(frozen=True)
class Row:
    """One snapshot: targets found, and milliseconds of resection, evidence and movement's cost, shape (3,)."""

    targets: int
    stages_ms: npt.NDArray[np.float64]


def main() -> int:
    """Build the map, detect, time, print."""
    parser = argparse.ArgumentParser(prog="speed_resection", description=__doc__)
    parser.add_argument("room", type=Path)
    parser.add_argument("--family", default="golay", choices=FAMILIES)
    parser.add_argument("--repeats", type=at_least_one, default=50)
    arguments = parser.parse_args()
    try:
        room = open_room(arguments.room, None)
        content = build_content(room, arguments.family)
        cv2.setNumThreads(1)
        known, photos = known_cameras(content), [*room.survey, *sorted((room.folder / "locate").glob("*.jpg"))]
        with threadpool_limits(limits=1):
            rows = [row for path in photos if (row := time_snapshot(path, content, known, arguments.repeats))]
    except ScattermarkError as error:
        print(f"speed_resection: {error.detail}", file=sys.stderr)
        return 1
    _print(rows)
    return 0


def time_snapshot(path: Path, content: MapFile, known: KnownCameras, repeats: int) -> Row | None:
    """One snapshot's times; None without a pose."""
    photo, target_map = load_photo(path.read_bytes()), content.target_map
    detection = detect_in_map(photo, content)
    try:
        best = resect_in_map(photo, detection, content, known)
    except NotLocated:
        return None
    tasks: tuple[Callable[[], object], ...] = (
        lambda: resect_in_map(photo, detection, content, known),
        lambda: gather_evidence(best.moving.observations, target_map, best.resection),
        lambda: rolling_shutter_of(best, target_map),
    )
    return Row(len(detection.targets), np.array([_least_ms(task, repeats) for task in tasks]))


def _least_ms(task: Callable[[], object], repeats: int) -> float:
    seconds = []
    for _ in range(repeats):
        began_s = time.thread_time()
        task()
        seconds.append(time.thread_time() - began_s)
    return MS_PER_S * min(seconds)


def _print(rows: list[Row]) -> None:
    cells = []
    for least, most in VIEWS:
        seen = [row.stages_ms for row in rows if least <= row.targets <= most]
        if seen:
            label = f"over {least - 1}" if most == VIEWS[-1][1] else f"{least}-{most}"
            cells.append([label, str(len(seen)), *(f"{stage_ms:.2f}" for stage_ms in np.median(seen, axis=0))])
    print_table(
        "detections to pose, one thread, median of snapshots",
        ["targets", "snapshots", "resection ms", "evidence ms", "movement's cost ms"],
        cells,
    )


if __name__ == "__main__":
    sys.exit(main())
