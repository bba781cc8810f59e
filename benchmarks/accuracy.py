"""Accuracy of the library in a room with truth: ``python -m benchmarks.accuracy ROOM``.

Recall by size and incidence, misread codes, dot centres, the target map beside what its control points allow, poses,
and whether the claimed uncertainties hold; by the default detector and by the published method, side by side. With
``--natural`` also the false targets in photographs without any.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from app.cli.arguments import FAMILIES, at_least_one, photo_files, positive
from app.cli.in_parallel import in_parallel
from app.cli.progress import Report, progress
from app.cli.room import Room, open_room, true_dots_m, true_shots
from app.errors import InvalidControlPoints, ScattermarkError, SurveyFailed
from benchmarks.accuracy_tables import print_accuracy
from benchmarks.coverage_score import score_coverage
from benchmarks.detecting import BOTH, DETECTOR_CHOICES, Reading, RoomRead, codes_in, named_detectors, read_room
from benchmarks.detection_score import score_detections, score_to_json
from benchmarks.map_score import score_map
from benchmarks.output import write_json
from benchmarks.pose_score import EstimatedPose, score_poses
from benchmarks.room_survey import Surveyed, locate_room, survey_room
from benchmarks.shared_dots import shared_dot_errors

MM_PER_M = 1000.0


def main() -> int:
    """Measure, print, write."""
    arguments = _arguments()
    readings = [Reading(name, arguments.family, arguments.workers) for name in named_detectors(arguments.detector)]
    try:
        room = open_room(arguments.room, None if arguments.u_mm is None else arguments.u_mm / MM_PER_M)
        with progress() as report:
            record = measure(room, readings, report)
            if arguments.natural is not None:
                for reading in readings:
                    found = count_false_targets(arguments.natural, reading, report)
                    record["detectors"][reading.detector]["natural"] = found
    except ScattermarkError as error:
        print(f"accuracy: {error.detail}", file=sys.stderr)
        return 1
    print_accuracy(record)
    name = record["room"] + ("" if arguments.detector == BOTH else f"-{arguments.detector}")
    write_json(arguments.out / f"accuracy-{name}.json", record)
    return 0


def measure(room: Room, readings: Sequence[Reading], report: Report) -> dict[str, Any]:
    """All figures of a room, by detector."""
    reads = [read_room(room, reading, report) for reading in readings]
    survey_truth = true_shots(room.folder / "survey")
    shared = shared_dot_errors([read.survey for read in reads], survey_truth)
    record: dict[str, Any] = {"room": room.folder.resolve().name, "detectors": {}}
    for read, errors_px in zip(reads, shared, strict=True):
        figures = measure_reading(room, read, report)
        figures["shared_base_dots"] = len(errors_px)
        figures["shared_base_dot_rmse_px"] = float(np.sqrt(np.square(errors_px).mean())) if len(errors_px) else None
        record["detectors"][read.reading.detector] = figures
    return record


def measure_reading(room: Room, read: RoomRead, report: Report) -> dict[str, Any]:
    """All figures of a room by one detector; a survey that gives no map is a figure too."""
    dots_m = true_dots_m(room)
    survey_truth, locate_truth = true_shots(room.folder / "survey"), true_shots(room.folder / "locate")
    record: dict[str, Any] = {
        "detection_survey": score_to_json(score_detections(read.survey, survey_truth, dots_m)),
        "detection_locate": score_to_json(score_detections(read.snapshots, locate_truth, dots_m)),
    }
    try:
        surveyed = survey_room(room, read.survey, read.reading.family_name, report)
    except (SurveyFailed, InvalidControlPoints) as failure:
        return {**record, "no_map": failure.detail}
    located = locate_room(room.snapshots, surveyed.content, read.reading.detector, report)
    true_poses = [{name: shot.site_from_cam for name, shot in t.shots.items()} for t in (survey_truth, locate_truth)]
    adjusted = [EstimatedPose(one.name, one.site_from_cam, one.covariance) for one in surveyed.survey.photos]
    return {
        **record,
        "survey": {
            **_survey_record(read, surveyed),
            "coverage": score_coverage(surveyed.survey.target_map, read.survey, survey_truth, dots_m),
            "cameras": [_camera_record(surveyed, survey_truth.camera.fx_px)],
        },
        "map": score_map(surveyed.survey.target_map, dots_m, surveyed.control),
        "survey_poses": score_poses(adjusted, true_poses[0]),
        "locate": score_poses(located.poses, true_poses[1]),
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


def _survey_record(read: RoomRead, surveyed: Surveyed) -> dict[str, Any]:
    return {
        "photographs": len(read.survey),
        "oriented": len(surveyed.survey.photos),
        "unoriented": surveyed.survey.unoriented,
        "build_s": read.survey_s + surveyed.adjust_s,
        "adjust_s": surveyed.adjust_s,
        "peak_bytes": surveyed.peak_bytes + read.reading.workers * read.peak_bytes,
    }


def _camera_record(surveyed: Surveyed, true_fx_px: float) -> dict[str, float]:
    calibrated = surveyed.survey.cameras[0].calibrated
    sigma_px = float(calibrated.covariance[0, 0] ** 0.5)
    return {"fx_error_px": calibrated.camera.fx_px - true_fx_px, "fx_sigma_px": sigma_px}


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="accuracy", description=__doc__)
    parser.add_argument("room", type=Path)
    parser.add_argument("--detector", default=BOTH, choices=DETECTOR_CHOICES)
    parser.add_argument("--natural", type=Path, metavar="DIR", help="photographs without any target")
    parser.add_argument("--family", default="golay", choices=FAMILIES)
    parser.add_argument("--u-mm", type=positive, help="printed module of the plates in mm (the room's own)")
    parser.add_argument("--workers", type=at_least_one, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("benchmarks/out"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
