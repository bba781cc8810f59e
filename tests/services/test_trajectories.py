from __future__ import annotations

import pytest

from app.errors import InvalidInput, NotFound
from app.services.trajectories import open_trajectory, time_range, trajectory_page
from app.storage.database import Database
from app.storage.paging import PageRequest, cursor_of
from app.storage.trajectory_parts import TimeRange
from tests.storage.walks import START_S, Step, add_walk, new_site

NOON_S = 1777636800.0  # 2026-05-01T12:00:00Z
STEPS = tuple(Step(0.1 * number, (1.0, 2.0, 1.5) if number % 3 else None) for number in range(10))


def test_a_trajectory_belongs_to_a_site_that_exists(database: Database) -> None:
    site_id = new_site(database)
    with database.writing() as session:
        opened = open_trajectory(session, site_id, "phone-1", "a walk")
        assert (opened.site_id, opened.device_id, opened.name) == (site_id, "phone-1", "a walk")
        with pytest.raises(NotFound, match="no site"):
            open_trajectory(session, "nowhere", None, "")


def test_times_are_iso_or_epoch_seconds() -> None:
    assert time_range("2026-05-01T12:00:00Z", f"{NOON_S + 1.5}") == TimeRange(NOON_S, NOON_S + 1.5)
    assert time_range(None, None) == TimeRange()
    with pytest.raises(InvalidInput, match="yesterday") as refused:
        time_range(None, "yesterday")
    assert refused.value.fields["field"] == "to"


def test_pages_hold_all_snapshots_and_the_trajectorys_totals(database: Database) -> None:
    trajectory_id = add_walk(database, new_site(database), STEPS)
    found: list[int] = []
    cursor: str | None = None
    with database.reading() as session:
        while True:
            page = trajectory_page(session, trajectory_id, TimeRange(START_S), PageRequest(3, cursor))
            assert (page.trajectory.pose_count, page.trajectory.failure_count) == (6, 4)
            labels = [*page.part.labels, *(failure.label for failure in page.part.failures)]
            found += sorted(label.ordinal for label in labels)
            cursor = page.next_cursor
            if cursor is None:
                break
    assert found == list(range(1, 11))


@pytest.mark.parametrize("key", ["", "1.0", "1.0/x", "nan/1", "inf/1", "1.0/0", "1.0/-3", f"1.0/{2**31}", "a/1"])
def test_a_cursor_that_no_page_gave_is_refused(sqlite_walk: tuple[Database, str], key: str) -> None:
    database, trajectory_id = sqlite_walk
    with database.reading() as session, pytest.raises(InvalidInput, match="cursor"):
        trajectory_page(session, trajectory_id, TimeRange(), PageRequest(3, cursor_of(key)))
