"""Accuracy of the library in a room with truth: ``python -m benchmarks.accuracy ROOM``.

Recall by size and incidence, misread codes, dot centres, the target map beside what its control points allow, poses,
and whether the claimed uncertainties hold. With ``--natural`` also the false targets in photographs without any.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path
from typing import Any

from app.cli.arguments import FAMILIES, at_least_one, photo_files, positive
from app.cli.in_parallel import in_parallel
from app.cli.progress import Report, progress
from app.cli.room import Room, open_room, true_dots_m, true_shots
from app.errors import ScattermarkError
from benchmarks.accuracy_tables import print_accuracy
from benchmarks.coverage_score import score_coverage
from benchmarks.detecting import DETECTORS, Reading, codes_in, detect_paths, peak_bytes
from benchmarks.detection_score import score_detections, score_to_json
from benchmarks.map_score import score_map
from benchmarks.output import write_json
from benchmarks.pose_score import EstimatedPose, score_poses
from benchmarks.room_survey import Surveyed, locate_room, survey_room

MM_PER_M = 1000.0


def main() -> int:
    """Measure, print, write."""
    arguments = _arguments()
    reading = Reading(arguments.detector, arguments.family, arguments.workers)
    try:
        room = open_room(arguments.room, None if arguments.u_mm is None else arguments.u_mm / MM_PER_M)
        with progress() as report:
            record = measure(room, reading, report)
            if arguments.natural is not None:
                record["natural"] = count_false_targets(arguments.natural, reading, report)
    except ScattermarkError as error:
        print(f"accuracy: {error.detail}", file=sys.stderr)
        return 1
    print_accuracy(record)
    name = room.folder.resolve().name + ("" if reading.detector == "default" else f"-{reading.detector}")
    write_json(arguments.out / f"accuracy-{name}.json", record)
    return 0


def measure(room: Room, reading: Reading, report: Report) -> dict[str, Any]:
    """All figures of a room."""
    dots_m = true_dots_m(room)
    survey_truth, locate_truth = true_shots(room.folder / "survey"), true_shots(room.folder / "locate")
    began_s = time.perf_counter()
    survey_read = detect_paths(room.survey, reading, report)
    detect_s = time.perf_counter() - began_s
    photos = [read.photo for read in survey_read]
    snapshot_read = detect_paths(room.snapshots, reading, report)
    surveyed = survey_room(room, photos, reading.family_name, report)
    located = locate_room(room.snapshots, surveyed.content, report)
    target_map = surveyed.survey.target_map
    return {
        "room": room.folder.resolve().name,
        "detector": reading.detector,
        "detection_survey": score_to_json(score_detections(photos, survey_truth, dots_m)),
        "detection_locate": score_to_json(
            score_detections([read.photo for read in snapshot_read], locate_truth, dots_m)
        ),
        "survey": {
            "photographs": len(room.survey),
            "oriented": len(surveyed.survey.photos),
            "unoriented": surveyed.survey.unoriented,
            "build_s": detect_s + surveyed.adjust_s,
            "adjust_s": surveyed.adjust_s,
            "peak_bytes": surveyed.peak_bytes + reading.workers * peak_bytes(survey_read),
            "coverage": score_coverage(target_map, photos, survey_truth, dots_m),
            "cameras": [_camera_record(surveyed, survey_truth.camera.fx_px)],
        },
        "map": score_map(target_map, dots_m, surveyed.control),
        "survey_poses": score_poses(
            [EstimatedPose(one.name, one.site_from_cam, one.covariance) for one in surveyed.survey.photos],
            {name: shot.site_from_cam for name, shot in survey_truth.shots.items()},
        ),
        "locate": score_poses(located.poses, {name: shot.site_from_cam for name, shot in locate_truth.shots.items()}),
        "refused": located.refused,
    }


def count_false_targets(folder: Path, reading: Reading, report: Report) -> dict[str, Any]:
    """Targets accepted in photographs that hold none."""
    paths = photo_files([folder])
    codes = in_parallel(codes_in, paths, (reading,), reading.workers, report)
    measured = [one for one in codes if one is not None]
    return {
        "photographs": len(measured),
        "not_measured": len(codes) - len(measured),
        "false_targets": sum(map(len, measured)),
        "where": {path.name: one for path, one in zip(paths, codes, strict=True) if one},
    }


def _camera_record(surveyed: Surveyed, true_fx_px: float) -> dict[str, float]:
    calibrated = surveyed.survey.cameras[0].calibrated
    sigma_px = float(calibrated.covariance[0, 0] ** 0.5)
    return {"fx_error_px": calibrated.camera.fx_px - true_fx_px, "fx_sigma_px": sigma_px}


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="accuracy", description=__doc__)
    parser.add_argument("room", type=Path)
    parser.add_argument("--detector", default="default", choices=DETECTORS)
    parser.add_argument("--natural", type=Path, metavar="DIR", help="photographs without any target")
    parser.add_argument("--family", default="golay", choices=FAMILIES)
    parser.add_argument("--u-mm", type=positive, help="printed module of the plates in mm (the room's own)")
    parser.add_argument("--workers", type=at_least_one, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("benchmarks/out"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
