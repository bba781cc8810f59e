"""Bytes to pose, stage by stage, as a multiple of decoding the JPEG alone: ``python -m benchmarks.speed ROOM``.

Everything on one thread. Each photograph is decoded alone and located alternately in the same run, so that a busy
machine slows both; per photograph the median of the repeats counts, per row the median of the photographs.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
from threadpoolctl import threadpool_limits

from app.cli.arguments import FAMILIES, at_least_one, positive
from app.cli.locate_photo import known_cameras, resect_in_map
from app.cli.progress import Report, progress
from app.cli.room import Room, open_room, true_shots
from app.errors import NotLocated, ScattermarkError
from app.geometry.map_file import MapFile
from app.jobs.pool import WorkerPool
from app.services.choose_camera import KnownCameras
from app.targets.family import CodeFamily, family_by_name
from app.vision.photo import DECODE_FLAGS, load_photo
from benchmarks.detecting import DETECTORS, Detector, Reading, detect_path, detect_with
from benchmarks.memory import peak_rss_bytes
from benchmarks.output import print_table, write_json
from benchmarks.room_survey import survey_room

MM_PER_M = 1000.0
MS_PER_S = 1000.0
BYTES_PER_GB = 1e9
STAGES = ("decode alone", "load", "detect", "resect")
VIEWS = ((1, 14), (15, 40), (41, 100), (101, 10**6))  # plates wholly in view


@dataclass(frozen=True)
class Timing:
    """One photograph.

    Attributes
    ----------
    plates : int
        Plates wholly in view.
    stages_s : ndarray of shape (4,)
        Median seconds of decoding alone, loading (header and decoding), detecting, resecting.
    located : bool
    """

    name: str
    plates: int
    stages_s: npt.NDArray[np.float64]
    located: bool

    @property
    def total_over_decode(self) -> float:
        """Bytes to pose over decoding alone."""
        return float(self.stages_s[1:].sum() / self.stages_s[0])


@dataclass(frozen=True)
class Bench:
    """What all photographs of a run share."""

    content: MapFile
    known: KnownCameras
    family: CodeFamily
    detector: Detector
    repeats: int


def main() -> int:
    """Build the map, time, print, write."""
    arguments = _arguments()
    try:
        room = open_room(arguments.room, None if arguments.u_mm is None else arguments.u_mm / MM_PER_M)
        plates = _plates_in_view(room)
        with progress() as report:
            content = _map_from_worker(room, arguments.family, report)
            family = family_by_name(arguments.family)
            bench = Bench(content, known_cameras(content), family, arguments.detector, arguments.repeats)
            cv2.setNumThreads(1)
            with threadpool_limits(limits=1):
                timings = _time_all([*room.snapshots, *room.survey], plates, bench, report)
    except ScattermarkError as error:
        print(f"speed: {error.detail}", file=sys.stderr)
        return 1
    record = _record(room, arguments.detector, timings)
    _print(record)
    name = room.folder.resolve().name + ("" if arguments.detector == "default" else f"-{arguments.detector}")
    write_json(arguments.out / f"speed-{name}.json", record)
    return 0


def build_content(room: Room, family_name: str) -> MapFile:
    """Map and cameras of a room by the library; runs in a worker, so that its memory does not count."""
    reading = Reading("default", family_name, 1)
    photos = [detect_path(path, reading).photo for path in room.survey]
    return survey_room(room, photos, family_name, lambda _stage, _done, _total: None).content


def _map_from_worker(room: Room, family_name: str, report: Report) -> MapFile:
    report("building the map", 0, 1)
    with WorkerPool(1, 0) as pool:
        content: MapFile = pool.submit(build_content, room, family_name).result()
    report("building the map", 1, 1)
    return content


def _plates_in_view(room: Room) -> dict[Path, int]:
    """Plates wholly in view by photograph, from the truth."""
    return {
        folder / name: sum(plate.code is not None for plate in shot.plates)
        for folder in (room.folder / "survey", room.folder / "locate")
        for name, shot in true_shots(folder).shots.items()
    }


def _time_all(paths: Sequence[Path], plates: dict[Path, int], bench: Bench, report: Report) -> list[Timing]:
    timings = []
    _time_once(paths[0].read_bytes(), bench)  # first calls pay for tables and imports
    for done, path in enumerate(paths, start=1):
        data = path.read_bytes()
        runs = [_time_once(data, bench) for _ in range(bench.repeats)]
        stages_s = np.median([stages for stages, _ in runs], axis=0)
        timings.append(Timing(path.name, plates[path], stages_s, runs[0][1]))
        report("timing", done, len(paths))
    return timings


def _time_once(data: bytes, bench: Bench) -> tuple[npt.NDArray[np.float64], bool]:
    """Seconds of each stage, shape (4,), and whether there was a pose."""
    moments_s = [time.perf_counter()]
    cv2.imdecode(np.frombuffer(data, dtype=np.uint8), DECODE_FLAGS)
    moments_s.append(time.perf_counter())
    photo = load_photo(data)
    moments_s.append(time.perf_counter())
    known_codes = frozenset(bench.content.target_map.by_code)
    detection = detect_with(bench.detector, photo.bgr, bench.family, known_codes)
    moments_s.append(time.perf_counter())
    try:
        resect_in_map(photo, detection, bench.content, bench.known)
        located = True
    except NotLocated:
        located = False
    moments_s.append(time.perf_counter())
    return np.diff(moments_s), located


def _record(room: Room, detector: Detector, timings: Sequence[Timing]) -> dict[str, Any]:
    rows = [_row(least, most, [one for one in timings if least <= one.plates <= most]) for least, most in VIEWS]
    return {
        "room": room.folder.resolve().name,
        "detector": detector,
        "rows": [row for row in rows if row is not None],
        "peak_bytes": peak_rss_bytes(),
        "photographs": timings,
    }


def _row(least: int, most: int, timings: Sequence[Timing]) -> dict[str, Any] | None:
    if not timings:
        return None
    stages_s = np.median([one.stages_s for one in timings], axis=0)
    multiples = np.median([one.stages_s[1:] / one.stages_s[0] for one in timings], axis=0)
    totals = [one.total_over_decode for one in timings]
    return {
        "plates": [least, most],
        "photographs": len(timings),
        "located": sum(one.located for one in timings),
        "stages_ms": dict(zip(STAGES, (MS_PER_S * stages_s).tolist(), strict=True)),
        "multiples": dict(zip(STAGES[1:], multiples.tolist(), strict=True)),
        "total_multiple": float(np.median(totals)),
        "worst_multiple": float(np.max(totals)),
    }


def _print(record: dict[str, Any]) -> None:
    stages = [f"{stage} x" for stage in STAGES[1:]]
    headings = ["plates in view", "photographs", "decode alone ms", *stages, "total x", "worst x"]
    title = f"{record['room']}, {record['detector']} detector: bytes to pose over decoding the JPEG alone, one thread"
    memory = f"memory at most {record['peak_bytes'] / BYTES_PER_GB:.2f} GB"
    print_table(f"{title}; {memory}", headings, [_cells(row) for row in record["rows"]])


def _cells(row: dict[str, Any]) -> list[str]:
    least, most = row["plates"]
    label = f"over {least - 1}" if most == VIEWS[-1][1] else f"{least}-{most}"
    multiples = [row["multiples"][stage] for stage in STAGES[1:]]
    multiples += [row["total_multiple"], row["worst_multiple"]]
    decode_ms = f"{row['stages_ms']['decode alone']:.1f}"
    return [label, str(row["photographs"]), decode_ms, *(f"{multiple:.2f}" for multiple in multiples)]


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="speed", description=__doc__)
    parser.add_argument("room", type=Path)
    parser.add_argument("--detector", default="default", choices=DETECTORS)
    parser.add_argument("--repeats", type=at_least_one, default=5)
    parser.add_argument("--family", default="golay", choices=FAMILIES)
    parser.add_argument("--u-mm", type=positive, help="printed module of the plates in mm (the room's own)")
    parser.add_argument("--out", type=Path, default=Path("benchmarks/out"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
