"""Trajectories of any length, put into a database by bulk insert."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
from sqlalchemy import insert, update

from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.storage.database import Database
from app.storage.ids import new_id
from app.storage.models import SnapshotRow, TrajectoryRow
from app.storage.snapshot_rows import values_of_snapshot
from app.storage.snapshots import Heading, Located, Moment, NewSnapshot, NotFoundPose, Seen, SeenTarget
from app.storage.trajectories import TrajectoryRepository

START_S = 1.78e9  # an afternoon of 2026
INTERVAL_S = 0.1  # ten poses a second
FAILURE_EVERY = 20  # of the snapshots of a walk; what is read then is a mixture
TEMPLATES = 500  # different poses and failures, repeated with times of their own
TARGETS_SEEN = 8  # of a snapshot of a room with targets on all walls
ROWS_AT_A_TIME = 5000
COVARIANCE = np.diag([1e-6, 1e-6, 4e-6, 1e-7, 1e-7, 1e-7])  # a good snapshot: 1 mm, 1 mm, 2 mm, 0.3 mrad


def add_long_trajectory(database: Database, site_id: str, count: int) -> str:
    """A trajectory of so many snapshots of a walk; its id."""
    with database.writing() as session:
        trajectory_id = TrajectoryRepository(session).add(site_id, "walker", f"{count} snapshots").trajectory_id
    rows = _rows(trajectory_id, site_id, count)
    while chunk := list(itertools.islice(rows, ROWS_AT_A_TIME)):
        with database.recording() as session:
            session.execute(insert(SnapshotRow.__table__), chunk)  # type: ignore[arg-type]
    totals = {
        "snapshot_count": count,
        "failures": {"no-targets": -(-count // FAILURE_EVERY)},
        "first_s": START_S,
        "last_s": START_S + (count - 1) * INTERVAL_S,
    }
    with database.writing() as session:
        session.execute(update(TrajectoryRow).where(TrajectoryRow.id == trajectory_id).values(**totals))
    return trajectory_id


def _rows(trajectory_id: str, site_id: str, count: int) -> Iterator[dict[str, Any]]:
    templates = [values_of_snapshot(_snapshot(site_id, number)) for number in range(TEMPLATES)]
    for index in range(count):
        captured_s = START_S + index * INTERVAL_S
        place = {"id": new_id(), "trajectory_id": trajectory_id, "ordinal": index + 1}
        yield {**templates[index % TEMPLATES], **place, "captured_s": captured_s, "received_s": captured_s}


def _snapshot(site_id: str, number: int) -> NewSnapshot:
    heading = Heading(site_id, 1, Moment(START_S, "client", 0.01), START_S, "walker")
    if number % FAILURE_EVERY == 0:
        return NewSnapshot(heading, NotFoundPose("no-targets", "no target was seen", "turn to a wall"), Seen())
    random = np.random.default_rng(number)
    angle = 2 * np.pi * number / TEMPLATES
    position_m = np.array([5 + 3 * np.cos(angle), 4 + 3 * np.sin(angle), 1.5])
    outcome = Located(Pose(exp_rotation(random.normal(size=3)), position_m), COVARIANCE, 1.0, 250, 0.06, "survey")
    codes = random.integers(1, 2**16, TARGETS_SEEN).tolist()
    seen = Seen(tuple(SeenTarget(code, 0, 0.06, True) for code in codes), (), (("total", 20.0),))
    return NewSnapshot(heading, outcome, seen)
