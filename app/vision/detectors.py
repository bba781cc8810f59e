"""The detectors by name: one list, and one way to call each, for the command line, builds and benchmarks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal, Protocol, get_args

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.geometry.observations import Detection
from app.targets.family import CodeFamily
from app.vision.detector import DETECTOR_VERSION, DetectorOptions, detect
from app.vision.paper import PAPER_VERSION, PaperOptions, detect_paper
from app.vision.reading import Strictness

Pixels = npt.NDArray[np.uint8]

DetectorName = Literal["default", "paper"]
DETECTOR_NAMES: tuple[DetectorName, ...] = get_args(DetectorName)


class Detector(Protocol):
    """A detector whose options are decided. Its ``repr`` tells them all, so that stored detections can be kept by it.

    Attributes
    ----------
    name : str
    version : str
        Changes whenever the same photograph could give other numbers.
    """

    name: ClassVar[DetectorName]
    version: ClassVar[str]

    def detect(self, bgr: Pixels, family: CodeFamily) -> Detection:
        """Find and read all targets in a photograph of shape (H, W, 3), uint8."""


@dataclass(frozen=True)
class DefaultDetector:
    """The default: colour proposes, the plate's own picture localises and judges.

    Attributes
    ----------
    options : DetectorOptions
    known_codes : frozenset of int or None
        The codes that the site holds: a mended code must be among them.
    """

    name: ClassVar[DetectorName] = "default"
    version: ClassVar[str] = DETECTOR_VERSION
    options: DetectorOptions = field(default_factory=DetectorOptions)
    known_codes: frozenset[int] | None = None

    def detect(self, bgr: Pixels, family: CodeFamily) -> Detection:
        """Find and read all targets in a photograph."""
        return detect(bgr, family, self.options, self.known_codes)


@dataclass(frozen=True)
class PublishedDetector:
    """The published method, the baseline of every comparison. It mends no code and so needs no list of them.

    Attributes
    ----------
    options : PaperOptions
    """

    name: ClassVar[DetectorName] = "paper"
    version: ClassVar[str] = PAPER_VERSION
    options: PaperOptions = field(default_factory=PaperOptions)

    def detect(self, bgr: Pixels, family: CodeFamily) -> Detection:
        """Find and read all targets in a photograph."""
        return detect_paper(bgr, family, self.options)


def choose_detector(
    name: DetectorName, strictness: Strictness | None = None, known_codes: frozenset[int] | None = None
) -> Detector:
    """The detector of a name.

    Parameters
    ----------
    name : str
        One of ``DETECTOR_NAMES``.
    strictness : str, optional
        How much the code family may mend; by default what the detector takes by itself.
    known_codes : frozenset of int, optional
        The codes that the site holds, for a detector that mends.

    Raises
    ------
    InvalidInput
        For an unknown name, or when the published method is told to mend: it cannot.
    """
    if name == "default":
        options = DetectorOptions() if strictness is None else DetectorOptions(strictness=strictness)
        return DefaultDetector(options, known_codes)
    if name != "paper":
        raise InvalidInput(f"there is no detector {name!r}; choose one of {', '.join(DETECTOR_NAMES)}", detector=name)
    if strictness not in (None, "strict"):
        raise InvalidInput(
            f"the published method mends no misread dot, so it cannot be {strictness}: say strict, or nothing",
            detector=name,
            strictness=strictness,
        )
    return PublishedDetector()
