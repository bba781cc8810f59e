"""What a worker does for one photograph on disk."""

from __future__ import annotations

from pathlib import Path

from app.cli.read_photo import read_photo
from app.photogrammetry.survey import SurveyPhoto
from app.targets.family import family_by_name
from app.vision.detectors import Detector


def detect_file(path: Path, family_name: str, detector: Detector) -> SurveyPhoto:
    """Read and detect; errors name the file."""
    photo = read_photo(path)
    return SurveyPhoto(path.name, photo.identity, detector.detect(photo.bgr, family_by_name(family_name)))
