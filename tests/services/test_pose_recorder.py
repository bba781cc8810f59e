"""Rows are committed in groups: many at once when many come, one at once when it is alone, all before the end."""

from __future__ import annotations

import asyncio
import threading
import uuid
from collections.abc import Sequence

import pytest

from app.errors import Conflict, ServerFull
from app.services import pose_recorder
from app.services.pose_recorder import GroupOptions, PoseRecorder
from app.storage.database import Database
from app.storage.models import SnapshotRow
from app.storage.records import Site
from app.storage.snapshot_group import Entry, record_snapshots
from app.storage.snapshots import Snapshot
from app.storage.trajectories import TrajectoryRepository
from tests.storage import examples
from tests.storage.test_snapshot_group import assert_gapless


@pytest.fixture
def site(sqlite_database: Database) -> Site:
    return examples.site_with_survey(sqlite_database)[0]


class Slow:
    """Records as ever, and only when it may; knows how large the groups were."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.may = threading.Event()
        self.began = threading.Event()
        self.sizes: list[int] = []
        monkeypatch.setattr(pose_recorder, "record_snapshots", self)

    def __call__(self, database: Database, entries: Sequence[Entry]) -> list[Snapshot | Exception]:
        self.began.set()
        self.may.wait()
        self.sizes.append(len(entries))
        return record_snapshots(database, entries)


def entry(site: Site, trajectory_id: str | None = None) -> Entry:
    return Entry(examples.snapshot(site, examples.located(), str(uuid.uuid4())), trajectory_id)


def never() -> bool:
    return False


def test_what_comes_during_a_commit_is_the_next_group(
    sqlite_database: Database, site: Site, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = Slow(monkeypatch)
    recorder = PoseRecorder(sqlite_database, never, GroupOptions(most_rows=4)).start()

    async def seven() -> list[Snapshot]:
        first = asyncio.create_task(recorder.record(entry(site)))
        await asyncio.to_thread(slow.began.wait)
        others = [asyncio.create_task(recorder.record(entry(site))) for _ in range(6)]
        await asyncio.sleep(0)  # they are handed over
        assert not first.done()  # the answer comes after the commit
        slow.may.set()
        return await asyncio.gather(first, *others)

    recorded = asyncio.run(seven())
    recorder.close()
    assert slow.sizes == [1, 4, 2]
    assert len({snapshot.pose_id for snapshot in recorded}) == 7
    assert_gapless(sqlite_database)


def test_in_a_crowd_a_row_waits_for_others(
    sqlite_database: Database, site: Site, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = Slow(monkeypatch)
    slow.may.set()
    patient = GroupOptions(most_rows=3, longest_wait_s=60.0)  # only the third row ends the wait
    recorder = PoseRecorder(sqlite_database, lambda: True, patient).start()

    async def three() -> None:
        await asyncio.gather(*(recorder.record(entry(site)) for _ in range(3)))

    asyncio.run(three())
    recorder.close()
    assert slow.sizes == [3]


def test_the_error_of_one_is_its_own(sqlite_database: Database, site: Site, monkeypatch: pytest.MonkeyPatch) -> None:
    with sqlite_database.writing() as session:
        closed = TrajectoryRepository(session).add(site.site_id, None, "").trajectory_id
        TrajectoryRepository(session).close(closed)
    slow = Slow(monkeypatch)
    slow.may.set()
    recorder = PoseRecorder(sqlite_database, lambda: True, GroupOptions(most_rows=3, longest_wait_s=60.0)).start()

    async def three() -> list[Snapshot | BaseException]:
        entries = [entry(site), entry(site, closed), entry(site)]
        return await asyncio.gather(*(recorder.record(one) for one in entries), return_exceptions=True)

    outcomes = asyncio.run(three())
    recorder.close()
    assert slow.sizes == [3]
    assert [type(outcome) for outcome in outcomes] == [Snapshot, Conflict, Snapshot]


def test_who_leaves_is_recorded_and_the_end_waits_for_all(
    sqlite_database: Database, site: Site, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = Slow(monkeypatch)
    recorder = PoseRecorder(sqlite_database, never).start()

    async def leave() -> None:
        waiting = [asyncio.create_task(recorder.record(entry(site))) for _ in range(3)]
        await asyncio.to_thread(slow.began.wait)
        for task in waiting:
            task.cancel()
        await asyncio.gather(*waiting, return_exceptions=True)
        slow.may.set()
        await asyncio.to_thread(recorder.close)

    asyncio.run(leave())
    assert sum(slow.sizes) == 3
    with sqlite_database.reading() as session:
        assert session.query(SnapshotRow).count() == 3


def test_a_stalled_database_is_said_before_memory_runs_out(
    sqlite_database: Database, site: Site, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow = Slow(monkeypatch)
    recorder = PoseRecorder(sqlite_database, never, GroupOptions(most_waiting=2)).start()

    async def too_many() -> None:
        first = asyncio.create_task(recorder.record(entry(site)))
        await asyncio.to_thread(slow.began.wait)
        waiting = [asyncio.create_task(recorder.record(entry(site))) for _ in range(2)]
        await asyncio.sleep(0)
        with pytest.raises(ServerFull, match="send the request again") as full:
            await recorder.record(entry(site))
        assert full.value.fields["retry_after_s"] >= 1
        slow.may.set()
        await asyncio.gather(first, *waiting)

    asyncio.run(too_many())
    recorder.close()


def test_a_recorder_that_does_not_run_says_so(sqlite_database: Database, site: Site) -> None:
    with pytest.raises(RuntimeError, match="call start"):
        asyncio.run(PoseRecorder(sqlite_database, never).record(entry(site)))
