"""What a worker process does for one snapshot: photo -> detect -> look up -> resect."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from app.errors import NotLocated
from app.geometry.camera import CalibratedCamera
from app.geometry.observations import Detection, Rejected
from app.geometry.target_map import TargetMap
from app.photogrammetry.evidence import gather_evidence
from app.photogrammetry.resection import Resection, ResectionOptions, resect
from app.photogrammetry.resection_refusals import check_dots
from app.services.choose_camera import KnownCameras, choose_cameras
from app.services.workbench import workbench
from app.storage.evidence_blob import blob_of_evidence
from app.storage.snapshots import Located, NotFoundPose, RefusedBlob, Seen, SeenTarget
from app.targets.family import family_by_name
from app.vision.detector import DetectorOptions, detect
from app.vision.photo import PhotoLimits, load_photo

MS_PER_S = 1000.0
TIMING_DIGITS = 2  # hundredths of a millisecond


@dataclass(frozen=True)
class LocateTask:
    """All that a worker needs beside the target map, which it holds or reads."""

    photo: bytes
    limits: PhotoLimits
    site_id: str
    map_version: int
    cameras: KnownCameras


@dataclass(frozen=True)
class LocateOutcome:
    """A pose or a refusal, what was seen, and what a pose tells of the map (``evidence_blob``)."""

    outcome: Located | NotFoundPose
    seen: Seen
    evidence: bytes | None = None


@dataclass
class _Stopwatch:
    """Milliseconds of each stage."""

    started_s: float = field(default_factory=time.perf_counter)
    stages_ms: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a stage, also one that ends by raising."""
        begun_s = time.perf_counter()
        try:
            yield
        finally:
            self.stages_ms[name] = MS_PER_S * (time.perf_counter() - begun_s)

    def timing_ms(self) -> tuple[tuple[str, float], ...]:
        """The stages in their order, then the total."""
        total_ms = MS_PER_S * (time.perf_counter() - self.started_s)
        stages = {**self.stages_ms, "total": total_ms}
        return tuple((name, round(milliseconds, TIMING_DIGITS)) for name, milliseconds in stages.items())


def locate_photo(task: LocateTask) -> LocateOutcome:
    """Locate one snapshot.

    Raises
    ------
    BadPhoto, UnsupportedPhoto, PhotoTooLarge
        For bytes that are no snapshot. A snapshot without a pose is a value, not an error: it is recorded.
    """
    watch = _Stopwatch()
    target_map = workbench().target_map(task.site_id, task.map_version)
    family = family_by_name(target_map.code_family)
    with watch.stage("decode"):
        photo = load_photo(task.photo, task.limits)
    with watch.stage("detect"):
        detection = detect(photo.bgr, family, DetectorOptions(), frozenset(target_map.by_code))
    try:
        with watch.stage("resect"):
            # Before the camera: a picture without targets is refused for that, whoever took it.
            known = [target for target in detection.targets if target.code in target_map.by_code]
            check_dots(detection.targets, known, ResectionOptions().min_dots)
            resection = resect_best(detection, target_map, choose_cameras(photo.header, task.cameras))
    except NotLocated as refusal:
        reason, advice = str(refusal.fields["reason"]), str(refusal.fields["advice"])
        return LocateOutcome(NotFoundPose(reason, refusal.detail, advice), _seen(detection, None, watch))
    evidence = gather_evidence(detection.targets, target_map, resection[0])
    return LocateOutcome(_located(resection), _seen(detection, resection, watch), blob_of_evidence(evidence))


def resect_best(
    detection: Detection, target_map: TargetMap, cameras: tuple[CalibratedCamera, ...]
) -> tuple[Resection, CalibratedCamera]:
    """The pose under the camera that explains the picture best; the first refusal when none gives a pose.

    Raises
    ------
    NotLocated
    """
    found: list[tuple[Resection, CalibratedCamera]] = []
    refusals: list[NotLocated] = []
    for camera in cameras:
        try:
            found.append((resect(detection.targets, target_map, camera), camera))
        except NotLocated as refusal:
            refusals.append(refusal)
    if not found:
        raise refusals[0]
    return min(found, key=lambda pair: pair[0].sigma0)


def _located(found: tuple[Resection, CalibratedCamera]) -> Located:
    resection, camera = found
    return Located(
        site_from_cam=resection.site_from_cam,
        covariance=resection.covariance,
        sigma0=float(resection.sigma0),
        redundancy=int(resection.redundancy),
        rms_residual_px=float(resection.rms_residual_px),
        camera_source=camera.source,
        ambiguity_ratio=resection.ambiguity_ratio,
    )


def _seen(detection: Detection, found: tuple[Resection, CalibratedCamera] | None, watch: _Stopwatch) -> Seen:
    used = {} if found is None else {target.code: target for target in found[0].targets}
    targets = []
    for observation in detection.targets:
        use = used.get(observation.code)
        targets.append(
            SeenTarget(
                code=observation.code,
                corrected=observation.corrected,
                rms_px=observation.rms_px if use is None else use.rms_px,
                used=use is not None and use.used,
                reason=None if use is None else use.reason,
            )
        )
    return Seen(tuple(targets), tuple(_refused(item) for item in detection.rejected), watch.timing_ms())


def _refused(rejected: Rejected) -> RefusedBlob:
    x_px, y_px = np.asarray(rejected.centre_px, dtype=np.float64).tolist()
    return RefusedBlob(rejected.reason, (x_px, y_px), rejected.code)
