"""Readers of square black-and-white tags, timed on the same photographs: OpenCV's ArUco and AprilTag 3.

They find no tags in photographs of our targets, so only their time is compared, and it flatters them: no tag is
decoded, refined or posed. AprilTag 3 comes with the extra ``bench``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module

import cv2
import numpy as np
import numpy.typing as npt

from app.errors import ScattermarkError

Pixels = npt.NDArray[np.uint8]

FAMILY = "tag36h11"  # 587 codes, about as many as golay's 728; both libraries know it


class PeerMissing(ScattermarkError):
    """A library that is to be compared is not installed."""

    slug = "peer-missing"


@dataclass(frozen=True)
class Peer:
    """A reader of tags.

    Attributes
    ----------
    name : str
        Library and setting; 1/2 is the decimation of the picture in which AprilTag looks for squares.
    count_tags : callable
        Grey photograph of shape (H, W), uint8, to the number of tags found.
    """

    name: str
    count_tags: Callable[[Pixels], int]


def open_peers() -> tuple[Peer, ...]:
    """All peers, each on one thread.

    Raises
    ------
    PeerMissing
        Without the extra ``bench``.
    """
    return (_aruco(False), _aruco(True), _april_tag(1.0), _april_tag(2.0))


def _aruco(aruco3: bool) -> Peer:
    parameters = cv2.aruco.DetectorParameters()
    parameters.useAruco3Detection = aruco3
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    detector = cv2.aruco.ArucoDetector(dictionary, parameters)

    def count_tags(grey: Pixels) -> int:
        _, codes, _ = detector.detectMarkers(grey)
        return 0 if codes is None else len(codes)

    return Peer("ArUco, aruco3" if aruco3 else "ArUco", count_tags)


def _april_tag(decimate: float) -> Peer:
    try:
        library = import_module("pupil_apriltags")
    except ModuleNotFoundError as error:
        raise PeerMissing(
            "AprilTag 3 is not installed: pip install '.[bench]' (for Python 3.11 to 3.13), or leave --peers out"
        ) from error
    # Its own end hands pointers on as 32 bits, which kills the process: the few that there are stay until that ends.
    kept = type("KeptDetector", (library.Detector,), {"__del__": lambda _: None})
    detector = kept(families=FAMILY, nthreads=1, quad_decimate=decimate)
    return Peer(f"AprilTag 3, 1/{decimate:g}", lambda grey: len(detector.detect(grey)))
