"""The story of a snapshot: photo -> detect -> look up -> resect -> record."""

from __future__ import annotations

import asyncio
import time
from dataclasses import asdict, dataclass, field

from app.errors import Conflict, NotLocated
from app.geometry.camera import CalibratedCamera
from app.services.capture_time import ClientClock, moment_of
from app.services.choose_camera import KnownCameras
from app.services.locate_work import LocateOutcome, LocateTask, locate_photo
from app.services.metrics import ServiceMetrics
from app.services.ports import CpuPool
from app.services.trajectory_bell import TrajectoryBell
from app.storage.cameras import CameraRepository
from app.storage.database import Database
from app.storage.sites import SiteRepository
from app.storage.snapshots import Heading, Located, NewSnapshot, NotFoundPose, Snapshot
from app.storage.trajectories import TrajectoryRepository
from app.vision.photo import PhotoLimits


@dataclass(frozen=True)
class LocateRequest:
    """A snapshot and what its client says of it.

    Attributes
    ----------
    photo : bytes
    site_id : str
    device_id, snapshot_id, trajectory_id, camera_id : str or None
    client_camera : CalibratedCamera or None
        Intrinsics that the client sent.
    clock : ClientClock
    """

    photo: bytes
    site_id: str
    device_id: str | None = None
    snapshot_id: str | None = None
    trajectory_id: str | None = None
    camera_id: str | None = None
    client_camera: CalibratedCamera | None = None
    clock: ClientClock = field(default_factory=ClientClock)


@dataclass(frozen=True)
class LocateLimits:
    """How large a snapshot may be and how long its work may take."""

    photo: PhotoLimits
    timeout_s: float


@dataclass(frozen=True)
class _Prepared:
    heading: Heading
    cameras: KnownCameras


class Locator:
    """Locates snapshots: rows by threads, pixels by the pool, nothing on the event loop."""

    def __init__(
        self, database: Database, pool: CpuPool, limits: LocateLimits, bell: TrajectoryBell, metrics: ServiceMetrics
    ) -> None:
        self._database = database
        self._pool = pool
        self._limits = limits
        self._bell = bell
        self._metrics = metrics

    async def locate(self, request: LocateRequest) -> Snapshot:
        """A snapshot's pose, recorded in its trajectory; a repeated ``snapshot_id`` gets the first answer.

        Raises
        ------
        NotLocated
            When there is no trustworthy pose; the refusal is recorded as well.
        NotFound, Conflict, InvalidInput, BadPhoto, UnsupportedPhoto, PhotoTooLarge
            When the request cannot be right; nothing is recorded.
        ServerFull, TimedOut, WorkerCrashed
            When the work could not be done; nothing is recorded and it may be sent again.
        """
        with self._metrics.answering():
            return _located_or_refused(await self._snapshot(request))

    async def _snapshot(self, request: LocateRequest) -> Snapshot:
        prepared = await asyncio.to_thread(self._prepare, request)
        if isinstance(prepared, Snapshot):
            return prepared
        heading = prepared.heading
        task = LocateTask(request.photo, self._limits.photo, heading.site_id, heading.map_version, prepared.cameras)
        outcome = await self._pool.run(locate_photo, task, timeout_s=self._limits.timeout_s)
        with self._metrics.recording(outcome.seen.timing_ms):
            snapshot = await asyncio.to_thread(self._record, request, heading, outcome)
        self._bell.ring(snapshot.trajectory_id)
        return snapshot

    def _prepare(self, request: LocateRequest) -> _Prepared | Snapshot:
        """The first answer to a repeat; else all that the work needs, so that a wrong request costs no worker."""
        received_s = time.time()
        moment = moment_of(request.clock, received_s)
        with self._database.reading() as session:
            trajectories = TrajectoryRepository(session)
            if request.snapshot_id is not None:
                first = trajectories.find(request.site_id, request.snapshot_id)
                if first is not None:
                    return first
            site = SiteRepository(session).get(request.site_id)
            if site.active_version is None:
                raise Conflict(
                    "the site has no target map yet; upload survey photographs and POST /surveys/{survey_id}/build",
                    site_id=site.site_id,
                )
            if request.trajectory_id is not None:
                trajectories.open_one(request.trajectory_id, site.site_id)
            cameras = CameraRepository(session)
            named = None if request.camera_id is None else cameras.get(request.camera_id).calibrated
            stored = cameras.candidates(site.site_id, request.device_id)
        known = KnownCameras(request.device_id, named, request.client_camera, stored)
        heading = Heading(site.site_id, site.active_version, moment, received_s, request.device_id, request.snapshot_id)
        return _Prepared(heading, known)

    def _record(self, request: LocateRequest, heading: Heading, outcome: LocateOutcome) -> Snapshot:
        with self._database.recording() as session:
            trajectories = TrajectoryRepository(session)
            trajectory_id = request.trajectory_id
            if trajectory_id is None:
                trajectory_id = trajectories.default(heading.site_id, heading.device_id).trajectory_id
            return trajectories.record(trajectory_id, NewSnapshot(heading, outcome.outcome, outcome.seen))


def _located_or_refused(snapshot: Snapshot) -> Snapshot:
    """The snapshot when it has a pose.

    Raises
    ------
    NotLocated
        With the reason, what was seen, the advice and where the refusal is recorded.
    """
    if isinstance(snapshot.outcome, Located):
        return snapshot
    refusal: NotFoundPose = snapshot.outcome
    raise NotLocated(
        refusal.detail,
        reason=refusal.reason,
        advice=refusal.advice,
        seen={
            "targets": [asdict(target) for target in snapshot.seen.targets],
            "rejected": [asdict(item) for item in snapshot.seen.rejected],
        },
        pose_id=snapshot.pose_id,
        trajectory_id=snapshot.trajectory_id,
        site_id=snapshot.heading.site_id,
        map_version=snapshot.heading.map_version,
    )
