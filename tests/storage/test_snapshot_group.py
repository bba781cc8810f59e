"""Many snapshots in one transaction: each has its own outcome, ordinals have no gap, the first with an id wins."""

from __future__ import annotations

import threading
import uuid
from dataclasses import replace

import pytest
from sqlalchemy import select
from sqlalchemy.exc import SQLAlchemyError

from app.errors import Conflict, NotFound
from app.storage.database import Database
from app.storage.models import SnapshotRow, TrajectoryRow
from app.storage.records import Site
from app.storage.sites import SiteRepository
from app.storage.snapshot_group import Entry, record_snapshots
from app.storage.snapshots import Located, Snapshot
from app.storage.trajectories import TrajectoryRepository
from tests.storage import examples


@pytest.fixture
def site(database: Database) -> Site:
    return examples.site_with_survey(database)[0]


def entry(site: Site, snapshot_id: str | None = None, trajectory_id: str | None = None) -> Entry:
    return Entry(examples.snapshot(site, examples.located(), snapshot_id), trajectory_id)


def new_trajectory(database: Database, site: Site, *, closed: bool = False) -> str:
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        trajectory_id = trajectories.add(site.site_id, None, "").trajectory_id
        if closed:
            trajectories.close(trajectory_id)
    return trajectory_id


def assert_gapless(database: Database) -> None:
    """Each trajectory's ordinals run from 1 to its count, and its failures are counted."""
    with database.reading() as session:
        for trajectory in session.scalars(select(TrajectoryRow)):
            rows = select(SnapshotRow).where(SnapshotRow.trajectory_id == trajectory.id).order_by(SnapshotRow.ordinal)
            found = session.scalars(rows).all()
            assert [row.ordinal for row in found] == list(range(1, trajectory.snapshot_count + 1))
            assert sum(trajectory.failures.values()) == sum(row.reason is not None for row in found)


def poses(outcomes: list[Snapshot | Exception]) -> list[str]:
    assert all(isinstance(outcome, Snapshot) for outcome in outcomes), outcomes
    return [outcome.pose_id for outcome in outcomes if isinstance(outcome, Snapshot)]


def test_what_is_wrong_with_one_is_not_the_others_fault(database: Database, site: Site) -> None:
    other, _ = examples.site_with_survey(database)
    gone = replace(site, site_id=str(uuid.uuid4()))
    closed, foreign = new_trajectory(database, site, closed=True), new_trajectory(database, other)
    mine = new_trajectory(database, site)
    outcomes = record_snapshots(
        database,
        [
            entry(site),
            entry(site, trajectory_id=closed),
            entry(gone),
            entry(site, trajectory_id=mine),
            entry(site, trajectory_id="nowhere"),
            entry(site, trajectory_id=foreign),
            entry(site),
        ],
    )
    kinds = [type(outcome) for outcome in outcomes]
    assert kinds == [Snapshot, Conflict, NotFound, Snapshot, NotFound, Conflict, Snapshot]
    assert_gapless(database)
    with database.reading() as session:
        assert session.query(SnapshotRow).count() == 3


def test_a_row_that_the_database_does_not_take_fails_alone(database: Database, site: Site) -> None:
    impossible = replace(examples.located(), sigma0=float("nan"))  # JSON has no such number
    bad = Entry(examples.snapshot(site, impossible))
    first, refused, last = record_snapshots(database, [entry(site), bad, entry(site)])
    assert isinstance(first, Snapshot)
    assert isinstance(refused, SQLAlchemyError | ValueError)
    assert isinstance(last, Snapshot)
    assert_gapless(database)


def test_an_id_is_recorded_once_in_one_group_and_over_several(database: Database, site: Site) -> None:
    one, two = str(uuid.uuid4()), str(uuid.uuid4())
    (before,) = record_snapshots(database, [entry(site, one)])
    group = [entry(site, two), entry(site), entry(site, one), entry(site, two)]
    found = poses(record_snapshots(database, group))
    assert isinstance(before, Snapshot)
    assert found[2] == before.pose_id
    assert found[3] == found[0]
    assert len(set(found)) == 3
    assert_gapless(database)


def test_the_second_of_an_id_takes_the_place_of_a_first_that_failed(database: Database, site: Site) -> None:
    name = str(uuid.uuid4())
    closed = new_trajectory(database, site, closed=True)
    failed, recorded = record_snapshots(database, [entry(site, name, closed), entry(site, name)])
    assert isinstance(failed, Conflict)
    assert isinstance(recorded, Snapshot)


def test_groups_that_cross_do_not_stand_in_each_others_way(database: Database, site: Site) -> None:
    other, _ = examples.site_with_survey(database)
    names = [str(uuid.uuid4()) for _ in range(6)]
    paths = {place.site_id: new_trajectory(database, place) for place in (site, other)}
    found: list[list[str]] = []

    def record(turn: int) -> None:
        places = [site, other] if turn % 2 else [other, site]  # no two groups in the same order
        entries = [
            entry(place, name, paths[place.site_id]) for place in places for name in names[:: 1 - 2 * (turn % 2)]
        ]
        entries += [entry(place) for place in places]
        by_name = dict(
            zip(
                [(e.snapshot.heading.site_id, e.snapshot.heading.snapshot_id) for e in entries],
                poses(record_snapshots(database, entries)),
                strict=True,
            )
        )
        found.append([by_name[place.site_id, name] for place in (site, other) for name in names])

    threads = [threading.Thread(target=record, args=(turn,)) for turn in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 6
    assert all(answers == found[0] for answers in found)  # whoever asked, the first one's answer
    assert_gapless(database)


def test_a_site_that_goes_takes_its_snapshots_with_it(database: Database, site: Site) -> None:
    poses(record_snapshots(database, [entry(site), entry(site)]))
    with database.writing() as session:
        SiteRepository(session).delete(site.site_id)
    outcomes = record_snapshots(database, [entry(site), entry(site)])
    assert [type(outcome) for outcome in outcomes] == [NotFound, NotFound]


def test_the_recorded_snapshot_is_what_was_given(database: Database, site: Site) -> None:
    given = entry(site, str(uuid.uuid4()))
    (recorded,) = record_snapshots(database, [given])
    assert isinstance(recorded, Snapshot)
    assert recorded.heading == given.snapshot.heading
    assert isinstance(recorded.outcome, Located)
