"""The story of a snapshot: photo -> detect -> look up -> resect -> record."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from dataclasses import asdict, dataclass
from typing import Self

from app.errors import NotLocated
from app.services.evidence_sieve import EvidenceSieve
from app.services.locate_prepare import Preparation, Prepared
from app.services.locate_request import LocateRequest as LocateRequest
from app.services.locate_work import LocateTask, locate_photo
from app.services.metrics import ServiceMetrics
from app.services.ports import CpuPool
from app.services.pose_recorder import PoseRecorder
from app.services.snapshot_keeper import SnapshotKeeper
from app.services.trajectory_bell import TrajectoryBell
from app.storage.database import Database
from app.storage.snapshot_group import Entry
from app.storage.snapshots import Located, NewSnapshot, NotFoundPose, Snapshot
from app.vision.photo import PhotoLimits

PREPARING_THREADS = 4  # each question takes a fraction of a millisecond


@dataclass(frozen=True)
class LocateLimits:
    """How large a snapshot may be and how long its work may take."""

    photo: PhotoLimits
    timeout_s: float


@dataclass(frozen=True)
class Afterwards:
    """Who learns of a recorded snapshot: those who watch its trajectory, and who keeps pictures."""

    bell: TrajectoryBell
    keeper: SnapshotKeeper


class Locator:
    """Locates snapshots: rows by threads, pixels by the pool, nothing on the event loop."""

    def __init__(
        self, database: Database, pool: CpuPool, limits: LocateLimits, afterwards: Afterwards, metrics: ServiceMetrics
    ) -> None:
        self._preparation = Preparation(database)
        self._threads = ThreadPoolExecutor(PREPARING_THREADS, "locate-prepare")
        self._recorder = PoseRecorder(database, lambda: pool.figures.waiting > 0)
        self._pool = pool
        self._limits = limits
        self._afterwards = afterwards
        self._metrics = metrics
        self._sieve = EvidenceSieve()

    @asynccontextmanager
    async def running(self) -> AsyncIterator[Self]:
        """Start what records; when the block ends, record what is left."""
        self._recorder.start()
        try:
            yield self
        finally:
            await asyncio.to_thread(self._recorder.close)
            self._threads.shutdown(cancel_futures=True)

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

    async def check(self, request: LocateRequest) -> None:
        """See that snapshots like this one could be located, without a look at the photograph.

        Raises
        ------
        NotFound, Conflict, InvalidInput
            As ``locate``.
        """
        await self._prepare(request)

    async def _prepare(self, request: LocateRequest) -> Prepared | Snapshot:
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._threads, self._preparation.prepare, request)

    async def _snapshot(self, request: LocateRequest) -> Snapshot:
        prepared = await self._prepare(request)
        if isinstance(prepared, Snapshot):
            return prepared
        heading = prepared.heading
        task = LocateTask(request.photo, self._limits.photo, heading.site_id, heading.map_version, prepared.cameras)
        outcome = await self._pool.run(locate_photo, task, timeout_s=self._limits.timeout_s)
        told = outcome.evidence if self._sieve.passes(heading, outcome.outcome) else None
        entry = Entry(NewSnapshot(heading, outcome.outcome, outcome.seen, told), request.trajectory_id)
        with self._metrics.recording(outcome.seen.timing_ms):
            snapshot = await self._recorder.record(entry)
        self._afterwards.bell.ring(snapshot.trajectory_id)
        await self._afterwards.keeper.keep(prepared.keep, snapshot, request.photo)
        return snapshot


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
