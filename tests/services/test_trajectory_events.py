from __future__ import annotations

import asyncio
import subprocess
import sys
import textwrap
from collections.abc import AsyncIterator
from contextlib import aclosing

import pytest

from app.errors import InvalidInput
from app.services import trajectory_bell, trajectory_events
from app.services.sites import delete_site
from app.services.trajectory_bell import TrajectoryBell
from app.services.trajectory_events import Arrivals, first_event, watch_trajectory
from app.storage.database import Database
from app.storage.trajectories import TrajectoryRepository
from tests.storage.walks import Step, add_steps, add_walk, new_site

HERE = (1.0, 2.0, 1.5)
PATIENCE_S = 60.0  # for what comes at once, on a machine that does much else

# Another process adds two snapshots and closes the trajectory.
ELSEWHERE = """
    import sys
    from app.storage.database import Database
    from app.storage.trajectories import TrajectoryRepository
    from tests.storage.walks import Step, add_steps
    database = Database(sys.argv[1])
    add_steps(database, sys.argv[2], sys.argv[3], [Step(1.0, (1.0, 2.0, 1.5)), Step(0.5)])
    with database.writing() as session:
        TrajectoryRepository(session).close(sys.argv[2])
    database.close()
"""


def came(arrivals: Arrivals) -> list[int]:
    failures = [failure.label for failure in arrivals.part.failures]
    return sorted(label.ordinal for label in [*arrivals.part.labels, *failures])


async def collect(stream: AsyncIterator[Arrivals]) -> list[int]:
    """What comes until the stream ends."""
    async with asyncio.timeout(PATIENCE_S):
        return [ordinal async for arrivals in stream for ordinal in came(arrivals)]


def test_a_backlog_comes_in_order_and_ends_with_the_closed_trajectory(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trajectory_events, "SNAPSHOTS_AT_A_TIME", 3)
    walk = add_walk(database, new_site(database), [Step(number, HERE if number % 2 else None) for number in range(8)])
    with database.writing() as session:
        TrajectoryRepository(session).close(walk)
    assert asyncio.run(collect(watch_trajectory(database, TrajectoryBell(), walk, 0))) == list(range(1, 9))
    assert asyncio.run(collect(watch_trajectory(database, TrajectoryBell(), walk, 6))) == [7, 8]
    assert asyncio.run(collect(watch_trajectory(database, TrajectoryBell(), walk, 8))) == []


def test_what_another_process_adds_is_seen(database: Database) -> None:
    site_id = new_site(database)
    walk = add_walk(database, site_id, [Step(0.0, HERE)])
    script = [sys.executable, "-c", textwrap.dedent(ELSEWHERE), database.url, walk, site_id]
    other = subprocess.Popen(script)
    try:
        assert asyncio.run(collect(watch_trajectory(database, TrajectoryBell(), walk, 1))) == [2, 3]
    finally:
        assert other.wait() == 0


def test_the_bell_wakes_those_who_watch(sqlite_database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trajectory_bell, "WATCH_INTERVAL_S", 2 * PATIENCE_S)  # only the bell is in time
    site_id = new_site(sqlite_database)
    walk = add_walk(sqlite_database, site_id, [Step(0.0, HERE)])
    bell = TrajectoryBell()

    async def story() -> list[int]:
        async with asyncio.timeout(PATIENCE_S), aclosing(watch_trajectory(sqlite_database, bell, walk, 0)) as stream:
            first = await anext(stream)
            waiting = asyncio.ensure_future(anext(stream))
            await asyncio.sleep(0)
            await asyncio.to_thread(add_steps, sqlite_database, walk, site_id, [Step(1.0)])
            bell.ring(walk)
            return came(first) + came(await waiting)

    assert asyncio.run(story()) == [1, 2]


def test_a_stream_ends_with_the_site(sqlite_database: Database) -> None:
    site_id = new_site(sqlite_database)
    walk = add_walk(sqlite_database, site_id, [Step(0.0, HERE)])

    async def story() -> list[int]:
        stream = watch_trajectory(sqlite_database, TrajectoryBell(), walk, 0)
        first = await anext(stream)
        with sqlite_database.writing() as session:
            delete_site(session, site_id)
        return came(first) + await collect(stream)

    assert asyncio.run(story()) == [1]


def test_a_stream_begins_after_what_was_seen(sqlite_database: Database) -> None:
    walk = add_walk(sqlite_database, new_site(sqlite_database), [Step(0.0, HERE), Step(1.0)])
    with sqlite_database.reading() as session:
        trajectory = TrajectoryRepository(session).get(walk)
    assert first_event(trajectory, None) == 2
    assert [first_event(trajectory, text) for text in ("0", "1", "2")] == [0, 1, 2]
    for text in ("3", "-1", "x", "", "1.0", "²", "9" * 5000):
        with pytest.raises(InvalidInput, match="no event had"):
            first_event(trajectory, text)
