"""An engine that notes what it is told and answers what a test says; the real one runs in tests/faults."""

from __future__ import annotations

from collections.abc import Iterable

from app.jobs.engine import Known, LeftBehind
from app.storage.jobs import JobRun


class StandIn:
    def __init__(self) -> None:
        self.left: dict[str, LeftBehind] = {}
        self.knows: dict[JobRun, Known] = {}
        self.started: list[JobRun] = []
        self.resumed: list[JobRun] = []
        self.resumed_chunks: list[str] = []
        self.cancelled: list[JobRun] = []

    def left_behind(self, worker_id: str) -> LeftBehind:
        return self.left.get(worker_id, LeftBehind(frozenset(), {}))

    def known(self, run: JobRun) -> Known:
        return self.knows.get(run, Known.NOTHING)

    def start(self, run: JobRun) -> None:
        self.started.append(run)

    def resume(self, run: JobRun) -> None:
        self.resumed.append(run)

    def resume_chunks(self, workflow_ids: Iterable[str]) -> None:
        self.resumed_chunks.extend(workflow_ids)

    def cancel(self, run: JobRun) -> None:
        self.cancelled.append(run)
