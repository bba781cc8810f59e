"""Detections of many photographs by either detector, from a pool of workers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from app.cli.in_parallel import in_parallel
from app.cli.progress import Report
from app.cli.read_photo import read_photo
from app.errors import UnsupportedPhoto
from app.geometry.observations import Detection
from app.photogrammetry.survey import SurveyPhoto
from app.targets.family import CodeFamily, family_by_name
from app.vision.detector import Pixels, detect
from benchmarks.memory import peak_rss_bytes

Detector = Literal["default", "paper"]
DETECTORS: tuple[Detector, ...] = ("default", "paper")


@dataclass(frozen=True)
class Reading:
    """How photographs are read: which detector, which codes, how many workers."""

    detector: Detector
    family_name: str
    workers: int


def detect_with(
    detector: Detector, bgr: Pixels, family: CodeFamily, known_codes: frozenset[int] | None = None
) -> Detection:
    """One photograph by one detector; the published one knows nothing of a site's codes."""
    if detector == "paper":
        from app.vision.paper import detect_paper

        return detect_paper(bgr, family)
    return detect(bgr, family, known_codes=known_codes)


@dataclass(frozen=True)
class Read:
    """A photograph's detection, and the memory that its worker has taken at most."""

    photo: SurveyPhoto
    peak_bytes: int


def detect_path(path: Path, reading: Reading) -> Read:
    """What a worker does for one photograph."""
    photo = read_photo(path)
    detection = detect_with(reading.detector, photo.bgr, family_by_name(reading.family_name))
    return Read(SurveyPhoto(path.name, photo.identity, detection), peak_rss_bytes())


def codes_in(path: Path, reading: Reading) -> list[int] | None:
    """Codes that are read in a photograph; None for one that is not measured at all, as a grey one."""
    try:
        return [target.code for target in detect_path(path, reading).photo.detection.targets]
    except UnsupportedPhoto:
        return None


def detect_paths(paths: Sequence[Path], reading: Reading, report: Report) -> list[Read]:
    """Detections in the order of the paths."""
    return in_parallel(detect_path, paths, (reading,), reading.workers, report)


def peak_bytes(read: Sequence[Read]) -> int:
    """Memory of the greediest worker."""
    return max(one.peak_bytes for one in read)
