"""Times of one photograph: decoding alone, loading, and what each reader makes of it.

Of the processor, on the one thread that does all of it: what else a machine does only takes its caches.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from app.cli.locate_photo import resect_in_map
from app.errors import NotLocated
from app.geometry.map_file import MapFile
from app.geometry.observations import Detection
from app.services.choose_camera import KnownCameras
from app.targets.family import CodeFamily
from app.vision.decoding import DECODE_FLAGS
from app.vision.detectors import Detector
from app.vision.photo import Photo, load_photo
from benchmarks.peers import Peer

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Outcome:
    """What a reader did with one photograph, once.

    Attributes
    ----------
    detect_s, resect_s : float
        A peer resects nothing.
    found : int
        Targets or tags.
    located : bool
    """

    detect_s: float
    resect_s: float
    found: int
    located: bool


@dataclass(frozen=True)
class Reader:
    """A detector followed by a resection, or a peer.

    Attributes
    ----------
    name : str
    gives_pose : bool
        False for a peer.
    read : callable
        A loaded photograph to its ``Outcome``.
    """

    name: str
    gives_pose: bool
    read: Callable[[Photo], Outcome]


@dataclass(frozen=True)
class Timing:
    """One reader on one photograph: seconds are medians of the repeats.

    Attributes
    ----------
    photo : str
    plates : int
        Plates wholly in view.
    reader : str
    gives_pose : bool
    decode_s : float
        Decoding the JPEG alone, which everything is compared with.
    stages_s : ndarray of shape (3,)
        Loading (header and decoding), detecting, resecting.
    found : int
        Targets or tags.
    located : bool
    """

    photo: str
    plates: int
    reader: str
    gives_pose: bool
    decode_s: float
    stages_s: Array
    found: int
    located: bool

    @property
    def multiples(self) -> Array:
        """The stages over decoding alone, shape (3,)."""
        return np.asarray(self.stages_s / self.decode_s)


def detector_reader(detector: Detector, content: MapFile, known: KnownCameras, family: CodeFamily) -> Reader:
    """Bytes to pose by one detector in a map that is known."""

    def read(photo: Photo) -> Outcome:
        began_s = time.thread_time()
        detection = detector.detect(photo.bgr, family)
        detected_s = time.thread_time()
        located = _has_pose(photo, detection, content, known)
        return Outcome(detected_s - began_s, time.thread_time() - detected_s, len(detection.targets), located)

    return Reader(detector.name, True, read)


def peer_reader(peer: Peer) -> Reader:
    """Pixels to tags by a peer; its grey picture is part of its work."""

    def read(photo: Photo) -> Outcome:
        began_s = time.thread_time()
        found = peer.count_tags(np.asarray(cv2.cvtColor(photo.bgr, cv2.COLOR_BGR2GRAY), dtype=np.uint8))
        return Outcome(time.thread_time() - began_s, 0.0, found, False)

    return Reader(peer.name, False, read)


def time_photo(path: Path, plates: int, reader: Reader, repeats: int) -> Timing:
    """One reader on one photograph; decoding alone takes turns with it, so that a busy machine slows both."""
    data = path.read_bytes()
    runs = [_run(data, reader) for _ in range(repeats)]
    seconds = np.median([(decode_s, load_s, one.detect_s, one.resect_s) for decode_s, load_s, one in runs], axis=0)
    _, _, outcome = runs[0]
    return Timing(
        photo=path.name,
        plates=plates,
        reader=reader.name,
        gives_pose=reader.gives_pose,
        decode_s=float(seconds[0]),
        stages_s=seconds[1:],
        found=outcome.found,
        located=outcome.located,
    )


def _run(data: bytes, reader: Reader) -> tuple[float, float, Outcome]:
    """Seconds of decoding alone and of loading, and what the reader did."""
    began_s = time.thread_time()
    cv2.imdecode(np.frombuffer(data, dtype=np.uint8), DECODE_FLAGS)
    decoded_s = time.thread_time()
    photo = load_photo(data)
    loaded_s = time.thread_time()
    return decoded_s - began_s, loaded_s - decoded_s, reader.read(photo)


def _has_pose(photo: Photo, detection: Detection, content: MapFile, known: KnownCameras) -> bool:
    try:
        resect_in_map(photo, detection, content, known)
    except NotLocated:
        return False
    return True
