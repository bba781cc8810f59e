"""How the cost grows with megapixels, with targets in view and with the site: ``python -m benchmarks.speed_scaling``.

The photographs are rendered, the map is the truth, everything runs on one thread. Each row is read in a worker process
of its own, whose greatest memory stands beside the times; its photograph is decoded alone and read alternately.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
from threadpoolctl import threadpool_limits

from app.cli.arguments import at_least_one
from app.cli.progress import Report, progress
from app.geometry.camera import CalibratedCamera, Camera
from app.geometry.observations import Detection
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.jobs.pool import WorkerPool
from app.photogrammetry.resection import resect
from app.planning.imaging import ImagingOptions
from app.planning.posting import RoomOptions
from app.planning.room import build_room
from app.planning.scene import PostedTarget
from app.planning.survey_plan import look_at, phone_camera
from app.planning.synthetic import RenderedPhoto, render
from app.targets.family import family_by_name
from app.vision.decoding import DECODE_FLAGS
from app.vision.detectors import Detector, choose_detector
from app.vision.photo import load_photo
from benchmarks.memory import peak_rss_bytes
from benchmarks.output import print_table, write_json

Array = npt.NDArray[np.float64]

MS_PER_S, BYTES_PER_MB, PIXELS_PER_MP = 1000.0, 1e6, 1e6
FRAMES_PX = ((1920, 1080), (2592, 1944), (4000, 3000))  # 2, 5 and 12 MP
TARGET_COUNTS = (10, 30, 60, 110)  # posted on the wall in view
SITE_COUNTS = (100, 1_000, 10_000, 100_000)
ROOM = RoomOptions(size_m=(7.0, 5.0, 2.8), walls=(2,), heights_m=(0.3, 2.5))
STATION_M, AIM_M = np.array([3.5, 0.6, 1.5]), np.array([3.4, 5.0, 1.4])
TARGET_SIGMA_M, TARGET_SIGMA_RAD = 2e-4, 1e-3
INTRINSIC_SIGMAS = np.array([1.0, 1.0, 1.0, 1.0, 2e-3, 4e-3, 1e-4, 1e-4, 3e-3])
FAMILY, SITE_FAMILY = "golay", "full"
SEED = 7
FIRST_READS = 3  # pay for tables


@dataclass(frozen=True)
class Work:
    """One photograph to be read in a worker.

    Attributes
    ----------
    photo : RenderedPhoto
    camera : Camera
    target_map : TargetMap
    repeats : int
    """

    photo: RenderedPhoto
    camera: Camera
    target_map: TargetMap
    repeats: int


@dataclass(frozen=True)
class Row:
    """What reading one photograph took.

    Attributes
    ----------
    megapixels : float
    site_targets, whole, found : int
        Targets in the map; seen wholly in the photograph; of these, found.
    stages_s : ndarray of shape (4,)
        Medians of the repeats: decoding the JPEG alone, loading, detecting, resecting.
    peak_bytes : int
        Greatest memory of the worker up to the pose.
    """

    megapixels: float
    site_targets: int
    whole: int
    found: int
    stages_s: Array
    peak_bytes: int

    @property
    def total_multiple(self) -> float:
        """Bytes to pose over decoding the JPEG alone."""
        return float(self.stages_s[1:].sum() / self.stages_s[0])


def main() -> int:
    """Render, read, print, write."""
    parser = argparse.ArgumentParser(prog="speed_scaling", description=__doc__)
    parser.add_argument("--repeats", type=at_least_one, default=9)
    parser.add_argument("--out", type=Path, default=Path("benchmarks/out"))
    arguments = parser.parse_args()
    with progress() as report:
        by_pixels = [_row(size_px, ROOM.targets, None, arguments.repeats, report) for size_px in FRAMES_PX]
        by_view = [_row(FRAMES_PX[0], count, None, arguments.repeats, report) for count in TARGET_COUNTS]
        by_site = [_row(FRAMES_PX[0], ROOM.targets, count, arguments.repeats, report) for count in SITE_COUNTS]
    tables = {"megapixels": by_pixels, "targets in view": by_view, "targets of the site": by_site}
    for title, rows in tables.items():
        _print_rows(f"by {title}: bytes to pose over decoding the JPEG alone, one thread", rows)
    write_json(arguments.out / "speed-scaling.json", tables)
    return 0


def read_photo(work: Work) -> Row:
    """Read a photograph again and again; runs in a worker."""
    cv2.setNumThreads(1)
    detector = choose_detector("default", known_codes=frozenset(work.target_map.by_code))
    pixels, seconds = np.frombuffer(work.photo.jpeg, dtype=np.uint8), []
    with threadpool_limits(limits=1):
        for _ in range(FIRST_READS):
            _, detection = _read_once(work, detector)
        peak_bytes = peak_rss_bytes()  # before the reference, whose decoder holds the picture twice
        for _ in range(work.repeats):
            begun_s = time.thread_time()
            cv2.imdecode(pixels, DECODE_FLAGS)
            decoded_s = time.thread_time()
            stages_s, detection = _read_once(work, detector)
            seconds.append((decoded_s - begun_s, *stages_s))
    whole = work.photo.whole_codes()
    return Row(
        megapixels=work.camera.width_px * work.camera.height_px / PIXELS_PER_MP,
        site_targets=len(work.target_map.targets),
        whole=len(whole),
        found=len(whole & {target.code for target in detection.targets}),
        stages_s=np.median(seconds, axis=0),
        peak_bytes=peak_bytes,
    )


def _read_once(work: Work, detector: Detector) -> tuple[Array, Detection]:
    """Seconds of loading, detecting and resecting, and what was seen."""
    begun_s = time.thread_time()
    photo = load_photo(work.photo.jpeg)
    loaded_s = time.thread_time()
    detection = detector.detect(photo.bgr, family_by_name(FAMILY))
    detected_s = time.thread_time()
    resect(detection.targets, work.target_map, CalibratedCamera(work.camera, np.diag(INTRINSIC_SIGMAS**2), "survey"))
    return np.diff([begun_s, loaded_s, detected_s, time.thread_time()]), detection


def _row(size_px: tuple[int, int], posted: int, of_site: int | None, repeats: int, report: Report) -> Row:
    """One photograph of a wall with so many targets, in a map of as many or of a larger site."""
    report(f"{size_px[0]} x {size_px[1]} px, {posted} targets", 0, 1)
    camera, room = phone_camera(*size_px), replace(ROOM, targets=posted)
    scene = build_room(room, family_by_name(FAMILY), SEED)
    photo = render(scene, camera, look_at(STATION_M, AIM_M), ImagingOptions(), SEED)
    mapped = [_mapped(target) for target in scene.targets]
    if of_site is not None:
        mapped = _with_others(mapped, of_site)
    datum = Datum(np.zeros(3), 1e-6 * np.eye(7))
    target_map = TargetMap(tuple(mapped), datum, FAMILY, room.u_m)
    with WorkerPool(1, 0) as pool:
        row: Row = pool.submit(read_photo, Work(photo, camera, target_map, repeats)).result()
    return row


def _mapped(target: PostedTarget) -> MappedTarget:
    """The target as a good survey would map it."""
    covariance = np.diag([TARGET_SIGMA_M**2] * 3 + [TARGET_SIGMA_RAD**2] * 3)
    return MappedTarget(target.code, target.site_from_target, target.dots_m(), covariance, 5, 0.1)


def _with_others(mapped: Sequence[MappedTarget], count: int) -> list[MappedTarget]:
    """As many targets as a larger site has: those in view, and others with other codes that are not seen."""
    codes = {target.code for target in mapped}
    free = (int(code) for code in family_by_name(SITE_FAMILY).codes if int(code) not in codes)
    others = [replace(mapped[0], code=code) for code, _ in zip(free, range(count - len(mapped)), strict=False)]
    return [*mapped, *others]


def _print_rows(title: str, rows: Sequence[Row]) -> None:
    headings = [
        "megapixels",
        "site",
        "whole",
        "found",
        "decode ms",
        "load ms",
        "detect ms",
        "resect ms",
        "total x",
        "memory MB",
    ]
    cells = [
        [
            f"{row.megapixels:.1f}",
            str(row.site_targets),
            str(row.whole),
            str(row.found),
            *(f"{MS_PER_S * stage_s:.1f}" for stage_s in row.stages_s),
            f"{row.total_multiple:.2f}",
            f"{row.peak_bytes / BYTES_PER_MB:.0f}",
        ]
        for row in rows
    ]
    print_table(title, headings, cells)


if __name__ == "__main__":
    sys.exit(main())
