"""What was recorded before trajectories counted is counted when they begin to."""

from __future__ import annotations

from dataclasses import replace

from sqlalchemy import text

from app.storage.database import Database
from app.storage.migrate import downgrade, upgrade
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import Label, TimeRange, TrajectoryPart
from app.storage.trajectory_queries import TrajectoryQueries
from tests.storage.walks import Step, add_walk, new_site

STEPS = (Step(5.0, (5.0, 1.0, 1.5)), Step(1.0), Step(2.0, reason="ambiguous"), Step(3.0))


def labels_of(part: TrajectoryPart) -> list[Label]:
    return [*part.labels, *(failure.label for failure in part.failures)]


def test_snapshots_are_numbered_and_counted(database: Database) -> None:
    site_id = new_site(database)
    walks = [add_walk(database, site_id, steps) for steps in (STEPS, STEPS[:1], ())]
    with database.reading() as session:
        before = [TrajectoryRepository(session).get(walk) for walk in walks]
        part_before = TrajectoryQueries(session).part(walks[0], TimeRange(), None, 10)
    downgrade(database, "0001")
    with database.reading() as session:
        assert session.execute(text("SELECT count(*) FROM snapshots")).scalar() == 5
    upgrade(database)
    with database.reading() as session:
        assert [TrajectoryRepository(session).get(walk) for walk in walks] == before
        part = TrajectoryQueries(session).part(walks[0], TimeRange(), None, 10)
    # Ids tell the order of arrival to the millisecond, in which these came: each has one ordinal, whichever.
    found, made = labels_of(part), labels_of(part_before)
    assert sorted(label.ordinal for label in found) == [1, 2, 3, 4]
    assert [replace(label, ordinal=0) for label in found] == [replace(label, ordinal=0) for label in made]
    assert [failure.refusal for failure in part.failures] == [failure.refusal for failure in part_before.failures]
    assert before[0].failures == (("ambiguous", 1), ("no-targets", 2))
