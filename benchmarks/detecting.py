"""Detections of a room's photographs by one of the detectors, from a pool of workers."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from app.cli.in_parallel import in_parallel
from app.cli.progress import Report
from app.cli.read_photo import read_photo
from app.cli.room import Room
from app.errors import UnsupportedPhoto
from app.photogrammetry.survey import SurveyPhoto
from app.targets.family import family_by_name
from app.vision.detectors import DETECTOR_NAMES, DetectorName, choose_detector
from benchmarks.memory import peak_rss_bytes

BOTH = "both"
DETECTOR_CHOICES = (*DETECTOR_NAMES, BOTH)


@dataclass(frozen=True)
class Reading:
    """How photographs are read: which detector, which codes, how many workers."""

    detector: DetectorName
    family_name: str
    workers: int


@dataclass(frozen=True)
class Read:
    """A photograph's detection, and the memory that its worker has taken at most."""

    photo: SurveyPhoto
    peak_bytes: int


@dataclass(frozen=True)
class RoomRead:
    """What one detector saw in a room.

    Attributes
    ----------
    reading : Reading
    survey, snapshots : tuple of SurveyPhoto
    survey_s : float
        Time that the survey's photographs took, all workers together.
    peak_bytes : int
        Memory of the greediest worker.
    """

    reading: Reading
    survey: tuple[SurveyPhoto, ...]
    snapshots: tuple[SurveyPhoto, ...]
    survey_s: float
    peak_bytes: int


def named_detectors(choice: str) -> tuple[DetectorName, ...]:
    """The detectors that one of ``DETECTOR_CHOICES`` stands for."""
    return tuple(name for name in DETECTOR_NAMES if choice in (name, BOTH))


def detect_path(path: Path, reading: Reading) -> Read:
    """What a worker does for one photograph."""
    photo = read_photo(path)
    detection = choose_detector(reading.detector).detect(photo.bgr, family_by_name(reading.family_name))
    return Read(SurveyPhoto(path.name, photo.identity, detection), peak_rss_bytes())


def codes_in(path: Path, reading: Reading) -> list[int] | None:
    """Codes that are read in a photograph; None for one that is not measured at all, as a grey one."""
    try:
        return [target.code for target in detect_path(path, reading).photo.detection.targets]
    except UnsupportedPhoto:
        return None


def read_room(room: Room, reading: Reading, report: Report) -> RoomRead:
    """Detections in all photographs of a room, in its order."""
    began_s = time.perf_counter()
    survey = _detect_all(room.survey, reading, report)
    survey_s = time.perf_counter() - began_s
    snapshots = _detect_all(room.snapshots, reading, report)
    return RoomRead(
        reading=reading,
        survey=tuple(read.photo for read in survey),
        snapshots=tuple(read.photo for read in snapshots),
        survey_s=survey_s,
        peak_bytes=max(read.peak_bytes for read in survey),
    )


def _detect_all(paths: Sequence[Path], reading: Reading, report: Report) -> list[Read]:
    return in_parallel(detect_path, paths, (reading,), reading.workers, report)
