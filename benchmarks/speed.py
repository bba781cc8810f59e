"""Bytes to pose, stage by stage, as a multiple of decoding the JPEG alone: ``python -m benchmarks.speed ROOM``.

Everything on one thread. Each photograph is decoded alone and read alternately in the same run, so that a busy machine
slows both; per photograph the median of the repeats counts, per row the median of the photographs. The published method
stands beside the default detector, and with ``--peers`` so do readers of square tags (their time alone: there are no
tags to find).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import cv2
from threadpoolctl import threadpool_limits

from app.cli.arguments import FAMILIES, at_least_one, positive
from app.cli.locate_photo import known_cameras
from app.cli.progress import Report, progress
from app.cli.room import Room, open_room, true_shots
from app.errors import ScattermarkError
from app.geometry.map_file import MapFile
from app.jobs.pool import WorkerPool
from app.targets.family import family_by_name
from app.vision.detectors import DetectorName, choose_detector
from benchmarks.detecting import BOTH, DETECTOR_CHOICES, Reading, detect_path, named_detectors
from benchmarks.output import write_json
from benchmarks.peers import Peer, open_peers
from benchmarks.room_survey import survey_room
from benchmarks.speed_tables import print_speed, speed_record
from benchmarks.timing import Reader, Timing, detector_reader, peer_reader, time_photo

MM_PER_M = 1000.0


def main() -> int:
    """Build the map, time, print, write."""
    arguments = _arguments()
    try:
        room = open_room(arguments.room, None if arguments.u_mm is None else arguments.u_mm / MM_PER_M)
        peers = open_peers() if arguments.peers else ()
        plates = _plates_in_view(room)
        with progress() as report:
            content = _map_from_worker(room, arguments.family, report)
            readers = _readers(named_detectors(arguments.detector), content, peers)
            cv2.setNumThreads(1)
            with threadpool_limits(limits=1):
                timings = _time_all(plates, readers, arguments.repeats, report)
    except ScattermarkError as error:
        print(f"speed: {error.detail}", file=sys.stderr)
        return 1
    record = speed_record(room.folder.resolve().name, timings)
    print_speed(record)
    name = record["room"] + ("" if arguments.detector == BOTH else f"-{arguments.detector}")
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
    """Plates wholly in view by photograph, from the truth: snapshots first."""
    return {
        folder / name: sum(plate.code is not None for plate in shot.plates)
        for folder in (room.folder / "locate", room.folder / "survey")
        for name, shot in true_shots(folder).shots.items()
    }


def _readers(detectors: Sequence[DetectorName], content: MapFile, peers: Sequence[Peer]) -> list[Reader]:
    """All detectors locate in the same map, the default detector's: a map is given when a snapshot comes."""
    known, family = known_cameras(content), family_by_name(content.target_map.code_family)
    codes = frozenset(content.target_map.by_code)
    ours = [detector_reader(choose_detector(name, known_codes=codes), content, known, family) for name in detectors]
    return [*ours, *map(peer_reader, peers)]


def _time_all(plates: dict[Path, int], readers: Sequence[Reader], repeats: int, report: Report) -> list[Timing]:
    timings: list[Timing] = []
    for done, (path, count) in enumerate(plates.items(), start=1):
        for reader in readers:
            if done == 1:
                time_photo(path, count, reader, 1)  # first calls pay for tables and imports
            timings.append(time_photo(path, count, reader, repeats))
        report("timing", done, len(plates))
    return timings


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="speed", description=__doc__)
    parser.add_argument("room", type=Path)
    parser.add_argument("--detector", default=BOTH, choices=DETECTOR_CHOICES)
    parser.add_argument("--peers", action="store_true", help="also readers of square tags (extra: bench)")
    parser.add_argument("--repeats", type=at_least_one, default=5)
    parser.add_argument("--family", default="golay", choices=FAMILIES)
    parser.add_argument("--u-mm", type=positive, help="printed module of the plates in mm (the room's own)")
    parser.add_argument("--out", type=Path, default=Path("benchmarks/out"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
