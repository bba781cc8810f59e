"""What a worker process does for one snapshot: photo -> detect -> look up -> resect."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from app.errors import NotLocated
from app.geometry.observations import Detection, Rejected
from app.geometry.target_map import TargetMap
from app.photogrammetry.evidence import gather_evidence
from app.photogrammetry.resection import Resection, ResectionOptions
from app.photogrammetry.resection_refusals import check_dots
from app.services.best_pose import BestPose, resect_best, rolling_shutter_of
from app.services.choose_camera import KnownCameras, choose_cameras
from app.services.workbench import workbench
from app.storage.evidence_blob import blob_of_evidence
from app.storage.snapshots import Focal, Located, NotFoundPose, RefusedBlob, Seen, SeenTarget
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
            best = resect_best(detection, target_map, choose_cameras(photo.header, task.cameras))
    except NotLocated as refusal:
        reason, advice = str(refusal.fields["reason"]), str(refusal.fields["advice"])
        return LocateOutcome(NotFoundPose(reason, refusal.detail, advice), _seen(detection, None, watch))
    # Held against the map as if the camera had stood still: a movement would look like one of the targets.
    evidence = gather_evidence(best.moving.observations, target_map, best.resection)
    return LocateOutcome(
        _located(best, target_map), _seen(detection, best.resection, watch), blob_of_evidence(evidence)
    )


def _located(best: BestPose, target_map: TargetMap) -> Located:
    resection, focal = best.resection, best.resection.camera
    return Located(
        site_from_cam=resection.site_from_cam,
        covariance=resection.covariance,
        sigma0=float(resection.sigma0),
        redundancy=int(resection.redundancy),
        rms_residual_px=float(resection.rms_residual_px),
        camera_source=best.camera.source,
        ambiguity_ratio=resection.ambiguity_ratio,
        focal=Focal(focal.camera.fx_px, float(np.sqrt(focal.covariance[0, 0]))),
        rolling_shutter=rolling_shutter_of(best, target_map),
    )


def _seen(detection: Detection, found: Resection | None, watch: _Stopwatch) -> Seen:
    used = {} if found is None else {target.code: target for target in found.targets}
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
