from __future__ import annotations

import threading

import numpy as np
import pytest
from sqlalchemy import select

from app.errors import Conflict, NotFound
from app.storage.database import Database
from app.storage.models import SnapshotRow, TrajectoryRow
from app.storage.snapshots import Located, Snapshot
from app.storage.trajectories import TrajectoryRepository
from tests.storage import examples

SNAPSHOT_ID = "0190c0de-0000-7000-8000-000000000001"


def assert_same_snapshot(mine: Snapshot, theirs: Snapshot) -> None:
    assert (mine.pose_id, mine.trajectory_id, mine.heading, mine.seen) == (
        theirs.pose_id,
        theirs.trajectory_id,
        theirs.heading,
        theirs.seen,
    )
    if isinstance(theirs.outcome, Located):
        assert isinstance(mine.outcome, Located)
        np.testing.assert_array_equal(mine.outcome.covariance, theirs.outcome.covariance)
        np.testing.assert_array_equal(mine.outcome.site_from_cam.rotation, theirs.outcome.site_from_cam.rotation)
        np.testing.assert_array_equal(mine.outcome.site_from_cam.position_m, theirs.outcome.site_from_cam.position_m)
        assert (mine.outcome.sigma0, mine.outcome.redundancy, mine.outcome.ambiguity_ratio) == (
            theirs.outcome.sigma0,
            theirs.outcome.redundancy,
            theirs.outcome.ambiguity_ratio,
        )
    else:
        assert mine.outcome == theirs.outcome


@pytest.mark.parametrize("outcome", [examples.located(), examples.REFUSED])
def test_poses_and_refusals_are_rows_of_the_trajectory(database: Database, outcome: object) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        trajectory = trajectories.default(site.site_id, "phone-1")
        made = trajectories.record(trajectory.trajectory_id, examples.snapshot(site, outcome, SNAPSHOT_ID))  # type: ignore[arg-type]
    with database.reading() as session:
        found = TrajectoryRepository(session).find(site.site_id, SNAPSHOT_ID)
        (listed,) = TrajectoryRepository(session).snapshots(trajectory.trajectory_id, 10)
    assert found is not None
    assert_same_snapshot(found, made)
    assert_same_snapshot(listed, made)


def test_a_repeated_snapshot_id_gets_the_first_row(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        trajectory_id = trajectories.default(site.site_id, None).trajectory_id
        first = trajectories.record(trajectory_id, examples.snapshot(site, examples.REFUSED, SNAPSHOT_ID))
        again = trajectories.record(trajectory_id, examples.snapshot(site, examples.located(), SNAPSHOT_ID))
        for _ in range(2):  # without an id each is a row of its own
            trajectories.record(trajectory_id, examples.snapshot(site, examples.located()))
        assert session.query(SnapshotRow).count() == 3
    assert_same_snapshot(again, first)


def test_one_default_trajectory_per_site_and_device_however_many_ask(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    found: list[str] = []

    def ask() -> None:
        with database.writing() as session:
            found.append(TrajectoryRepository(session).default(site.site_id, "phone-1").trajectory_id)

    threads = [threading.Thread(target=ask) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    with database.writing() as session:
        other = TrajectoryRepository(session).default(site.site_id, None)
        assert other.default
        assert session.query(TrajectoryRow).count() == 2
    assert len(found) == 8
    assert len(set(found)) == 1
    assert other.trajectory_id not in found


def test_only_an_open_trajectory_of_the_site_takes_snapshots(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    other, _ = examples.site_with_survey(database)
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        mine = trajectories.default(site.site_id, None)
        assert trajectories.open_one(mine.trajectory_id, site.site_id) == mine
        with pytest.raises(NotFound, match="no trajectory"):
            trajectories.open_one("nowhere", site.site_id)
        with pytest.raises(Conflict, match="belongs to site"):
            trajectories.open_one(mine.trajectory_id, other.site_id)
        trajectories.close(mine.trajectory_id)
        with pytest.raises(Conflict, match="is closed"):
            trajectories.open_one(mine.trajectory_id, site.site_id)
        with pytest.raises(Conflict, match="is closed"):
            trajectories.record(mine.trajectory_id, examples.snapshot(site, examples.located()))


def test_closing_twice_is_closing_once(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        opened = trajectories.add(site.site_id, "phone-1", "a walk")
        assert (opened.closed_s, opened.default, opened.snapshot_count) == (None, False, 0)
        closed = trajectories.close(opened.trajectory_id)
        assert closed.closed_s is not None
        assert trajectories.close(opened.trajectory_id) == closed
        assert trajectories.get(opened.trajectory_id) == closed
        with pytest.raises(NotFound, match="no trajectory"):
            trajectories.close("nowhere")


def test_an_id_of_the_client_opens_one_trajectory_however_often_it_asks(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        first = trajectories.add(site.site_id, "phone-1", "a walk", SNAPSHOT_ID)
        trajectories.close(first.trajectory_id)
    with database.writing() as session:
        again = TrajectoryRepository(session).add(site.site_id, "phone-1", "a walk", SNAPSHOT_ID)
        assert session.query(TrajectoryRow).count() == 1
    assert first.trajectory_id == again.trajectory_id == SNAPSHOT_ID
    assert again.closed_s is not None
    elsewhere, _ = examples.site_with_survey(database)
    with pytest.raises(Conflict, match=SNAPSHOT_ID), database.writing() as session:
        TrajectoryRepository(session).add(elsewhere.site_id, None, "", SNAPSHOT_ID)


def test_after_a_closed_default_comes_another(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        first = trajectories.default(site.site_id, "phone-1")
        assert not trajectories.close(first.trajectory_id).default
        second = trajectories.default(site.site_id, "phone-1")
    assert second.default
    assert second.trajectory_id != first.trajectory_id


def test_a_trajectory_counts_what_it_holds(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        trajectory_id = trajectories.add(site.site_id, None, "").trajectory_id
        for outcome in (examples.located(), examples.REFUSED, examples.REFUSED):
            trajectories.record(trajectory_id, examples.snapshot(site, outcome))
        trajectories.record(trajectory_id, examples.snapshot(site, examples.located(), SNAPSHOT_ID))
        trajectories.record(trajectory_id, examples.snapshot(site, examples.located(), SNAPSHOT_ID))  # a repeat
    with database.reading() as session:
        found = TrajectoryRepository(session).get(trajectory_id)
    assert (found.pose_count, found.failure_count, found.snapshot_count) == (2, 2, 4)
    assert found.failures == (("too-few-dots", 2),)
    assert found.first_s == found.last_s == 1777627800.25


def test_ordinals_have_no_gap_however_many_record(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        trajectory_id = TrajectoryRepository(session).add(site.site_id, None, "").trajectory_id

    def walk() -> None:
        for _ in range(10):
            with database.recording() as session:
                TrajectoryRepository(session).record(trajectory_id, examples.snapshot(site, examples.located()))

    threads = [threading.Thread(target=walk) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    with database.reading() as session:
        ordinals = session.scalars(select(SnapshotRow.ordinal).order_by(SnapshotRow.ordinal)).all()
        assert TrajectoryRepository(session).get(trajectory_id).snapshot_count == 60
    assert ordinals == list(range(1, 61))
