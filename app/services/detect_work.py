"""What a worker process does for one survey photograph: read, detect, keep the detection."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from app.errors import InvalidInput
from app.services.build_options import BuildOptions, Strictness
from app.services.workbench import workbench
from app.storage.surveys import DetectionKey, DetectionRepository
from app.targets.family import family_by_name
from app.vision.detectors import Detector, DetectorName, choose_detector
from app.vision.photo import PhotoLimits, load_photo


@dataclass(frozen=True)
class DetectSettings:
    """What beside the photograph decides what is detected."""

    code_family: str
    detector_name: DetectorName
    strictness: Strictness

    @classmethod
    def of(cls, code_family: str, options: BuildOptions) -> DetectSettings:
        """What a build asks for on a site of that family."""
        return cls(code_family, options.detector, options.strictness)

    @property
    def detector(self) -> Detector:
        """Who reads the photograph.

        Raises
        ------
        InvalidInput
            When the detector cannot be as strict as that.
        """
        return choose_detector(self.detector_name, self.strictness)

    def key(self, sha256: str) -> DetectionKey:
        """Under what a photograph's detection is kept; any changed option gives another key."""
        detector = self.detector
        digest = hashlib.sha256(f"{self.code_family} {detector!r}".encode()).hexdigest()
        return DetectionKey(sha256, detector.version, digest)


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
    detection = task.settings.detector.detect(photo.bgr, family_by_name(task.settings.code_family))
    with bench.database.writing() as session:
        DetectionRepository(session).put(task.settings.key(task.sha256), detection)
    return None
