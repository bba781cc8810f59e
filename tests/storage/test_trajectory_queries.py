from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sqlalchemy import select, text

from app.storage.database import Database
from app.storage.models import SnapshotRow
from app.storage.paging import PageRequest
from app.storage.trajectory_parts import Box, Place, TimeRange, TrajectoryFilter, TrajectoryPart
from app.storage.trajectory_queries import TrajectoryQueries, in_time
from tests.storage.walks import START_S, Step, add_walk, new_site

EVERYTHING = TimeRange()
# As they came: out of order, two of one time, failures among them.
STEPS = (
    Step(5.0, (5.0, 1.0, 1.5)),
    Step(1.0, (1.0, 1.0, 1.5)),
    Step(2.0),
    Step(3.0, (3.0, 1.0, 1.5), sigma_m=0.004),
    Step(3.0, (3.5, 1.0, 1.5)),
    Step(4.0, reason="ambiguous"),
)
IN_TIME = [2, 3, 4, 5, 6, 1]  # ordinals in the order of time, at one time by arrival


def ordinals(part: TrajectoryPart) -> list[int]:
    """Of poses and failures in the order of time."""
    labels = [*part.labels, *(failure.label for failure in part.failures)]
    return [label.ordinal for label in sorted(labels, key=lambda label: (label.moment.captured_s, label.ordinal))]


@pytest.fixture
def walk(database: Database) -> str:
    site_id = new_site(database)
    add_walk(database, site_id, STEPS)  # another one beside it
    return add_walk(database, site_id, STEPS)


def test_parts_follow_one_another_without_gap_or_repeat(database: Database, walk: str) -> None:
    with database.reading() as session:
        for limit in (1, 2, 3, 6, 100):
            assert in_parts(TrajectoryQueries(session), walk, limit) == IN_TIME


def in_parts(queries: TrajectoryQueries, walk: str, limit: int) -> list[int]:
    found: list[int] = []
    after: Place | None = None
    while True:
        part = queries.part(walk, EVERYTHING, after, limit)
        assert len(part.labels) + len(part.failures) <= limit
        found += ordinals(part)
        if part.end is None:
            return found
        after = part.end


def test_poses_come_as_arrays_with_their_labels(database: Database, walk: str) -> None:
    with database.reading() as session:
        part = TrajectoryQueries(session).part(walk, EVERYTHING, None, 100)
    np.testing.assert_array_equal(part.poses.times_s, [START_S + 1.0, START_S + 3.0, START_S + 3.0, START_S + 5.0])
    np.testing.assert_array_equal(part.poses.positions_m[:, 0], [1.0, 3.0, 3.5, 5.0])
    assert part.poses.sigmas is not None
    np.testing.assert_allclose(part.poses.sigmas[:, 1], [0.001, 0.004, 0.001, 0.001])
    label = part.labels[1]
    assert (label.ordinal, label.moment.source, label.map_version, label.device_id) == (4, "client", 2, "walker")
    assert [failure.refusal.reason for failure in part.failures] == ["no-targets", "ambiguous"]
    assert part.failures[0].refusal.advice == "move closer"


# From, to (seconds after the start) and who is in between.
RANGES = (
    (1.0, 5.0, [2, 3, 4, 5, 6]),
    (3.0, None, [4, 5, 6, 1]),
    (None, 3.0, [2, 3]),
    (3.0, 3.5, [4, 5]),
    (6.0, 7.0, []),
)


def test_a_range_takes_its_beginning_and_not_its_end(database: Database, walk: str) -> None:
    with database.reading() as session:
        queries = TrajectoryQueries(session)
        for *ends, expected in RANGES:
            times = TimeRange(*(None if end is None else START_S + end for end in ends))
            assert ordinals(queries.part(walk, times, None, 100)) == expected
            poses, end = queries.poses(walk, times, None, 100)
            assert poses.times_s.tolist() == [
                START_S + STEPS[n - 1].after_s for n in expected if STEPS[n - 1].position_m
            ]
            assert end is None


def test_arrivals_follow_the_order_in_which_they_came(database: Database, walk: str) -> None:
    with database.reading() as session:
        queries = TrajectoryQueries(session)
        assert sorted(ordinals(queries.arrivals(walk, 0, 4))) == [1, 2, 3, 4]
        assert sorted(ordinals(queries.arrivals(walk, 4, 4))) == [5, 6]
        assert ordinals(queries.arrivals(walk, 6, 4)) == []


HERE, FAR = Box.of_numbers([2.9, 0.9, 3.1, 1.1]), Box.of_numbers([100.0, 0.0, 101.0, 9.0])


# What is asked, and whether the walk is found.
QUESTIONS: tuple[tuple[dict[str, Any], bool], ...] = (
    ({}, True),
    ({"device_id": "walker"}, True),
    ({"device_id": "sitter"}, False),
    ({"times": TimeRange(START_S + 2.0, START_S + 2.5)}, True),  # a failure fits a time
    ({"times": TimeRange(START_S + 5.5, None)}, False),
    ({"box": HERE}, True),
    ({"box": FAR}, False),
    ({"box": Box.of_numbers([0.0, 0.0, 1.6, 9.0, 9.0, 9.0])}, False),
    ({"box": HERE, "max_sigma_m": 0.004}, True),
    ({"box": HERE, "max_sigma_m": 0.002}, False),  # the pose in the box is worse than another elsewhere
    ({"max_sigma_m": 0.0009}, False),
    ({"times": TimeRange(START_S + 2.0, START_S + 2.5), "max_sigma_m": 1.0}, False),  # a failure has no sigma
)


def test_a_trajectory_is_found_by_a_snapshot_that_fits_all(database: Database) -> None:
    site_id, other_site_id = new_site(database), new_site(database)
    trajectory_id = add_walk(database, site_id, STEPS)
    with database.reading() as session:
        for asked, found in QUESTIONS:
            page = TrajectoryQueries(session).page(TrajectoryFilter(site_id, **asked), PageRequest())
            assert [item.trajectory_id for item in page.items] == ([trajectory_id] if found else []), asked
        assert TrajectoryQueries(session).page(TrajectoryFilter(other_site_id), PageRequest()).items == ()


def test_trajectories_come_page_by_page(database: Database) -> None:
    site_id = new_site(database)
    made = sorted(add_walk(database, site_id, []) for _ in range(5))  # within a millisecond ids have no order
    found: list[str] = []
    cursor: str | None = None
    with database.reading() as session:
        while True:
            page = TrajectoryQueries(session).page(TrajectoryFilter(site_id), PageRequest(2, cursor))
            found += [item.trajectory_id for item in page.items]
            cursor = page.next_cursor
            if cursor is None:
                break
    assert found == made


def test_a_page_follows_the_index_and_sorts_nothing(database: Database) -> None:
    times, place = TimeRange(START_S, START_S + 9.0), Place(START_S + 1.0, 1)
    query = in_time(select(SnapshotRow.id), "walk", times, place).limit(100)
    dialect = database.reader.dialect
    words = "EXPLAIN" if dialect.name == "postgresql" else "EXPLAIN QUERY PLAN"
    explained = f"{words} {query.compile(dialect=dialect, compile_kwargs={'literal_binds': True})}"
    with database.reading() as session:
        if dialect.name == "postgresql":
            session.execute(text("SET LOCAL enable_seqscan = off"))  # an empty table needs no index
            session.execute(text("SET LOCAL enable_bitmapscan = off"))
            session.execute(text("SET LOCAL enable_sort = off"))  # a few rows are sorted as cheaply by another index
        plan = " ".join(str(line[-1]) for line in session.execute(text(explained)))
    assert "ix_snapshots_by_time" in plan
    assert "Sort" not in plan
    assert "TEMP B-TREE" not in plan
