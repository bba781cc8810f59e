"""What a worker process does for one survey photograph: read, detect, keep the detection."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from app.errors import InvalidInput
from app.services.build_options import Strictness
from app.services.workbench import workbench
from app.storage.surveys import DetectionKey, DetectionRepository
from app.targets.family import family_by_name
from app.vision.detector import DETECTOR_VERSION, DetectorOptions, detect
from app.vision.photo import PhotoLimits, load_photo


@dataclass(frozen=True)
class DetectSettings:
    """What beside the photograph decides what is detected."""

    code_family: str
    strictness: Strictness

    @property
    def options(self) -> DetectorOptions:
        """The detector's options."""
        return DetectorOptions(strictness=self.strictness)

    def key(self, sha256: str) -> DetectionKey:
        """Under what a photograph's detection is kept; any changed option gives another key."""
        digest = hashlib.sha256(f"{self.code_family} {self.options!r}".encode()).hexdigest()
        return DetectionKey(sha256, DETECTOR_VERSION, digest)


@dataclass(frozen=True)
class DetectTask:
    """One photograph of the store."""

    sha256: str
    settings: DetectSettings
    limits: PhotoLimits


def detect_photo(task: DetectTask) -> str | None:
    """Detect in one photograph and keep the result; a repeat changes nothing.

    Returns
    -------
    str or None
        Why the photograph cannot be used, None when it can: one bad photograph does not end a survey.
    """
    bench = workbench()
    try:
        photo = load_photo(bench.photos.read(task.sha256), task.limits)
    except InvalidInput as error:
        return error.detail
    detection = detect(photo.bgr, family_by_name(task.settings.code_family), task.settings.options)
    with bench.database.writing() as session:
        DetectionRepository(session).put(task.settings.key(task.sha256), detection)
    return None
