"""Poses as arrays on both databases: whole, by time, page by page."""

from __future__ import annotations

import numpy as np
import pytest

from app.storage import pose_blobs
from app.storage.database import Database
from app.storage.imported_trajectories import ImportedTrajectories, NewImport
from app.storage.models import ImportedPosesRow
from app.storage.pose_reading import all_poses, pose_parts
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import FileSource, StoredTrajectory, TimeRange
from app.trajectories.trajectory import Trajectory
from tests.storage.walks import new_site
from tests.trajectories.walks import START_S, walk

COUNT = 25


@pytest.fixture(autouse=True)
def few_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pose_blobs, "POSES_A_ROW", 10)


def poses(freedoms: int) -> Trajectory:
    """Poses that tell everything, or positions alone."""
    roots = np.random.default_rng(1).normal(size=(COUNT, freedoms, freedoms))
    whole = walk(COUNT / 10.0, covariances=None)
    orientations = whole.orientations_xyzw if freedoms == 6 else None
    floors = np.arange(COUNT) if freedoms == 3 else None
    return Trajectory(whole.times_s, whole.positions_m, orientations, roots @ roots.transpose(0, 2, 1), floors)


def kept(database: Database, trajectory: Trajectory) -> StoredTrajectory:
    site_id = new_site(database)
    source = FileSource("tum", "s", "the stamps count s since 1970", trajectory.floors is None, True, False)
    with database.writing() as session:
        return ImportedTrajectories(session).add(NewImport(site_id, "uwb", "walk", source, trajectory))


def assert_same(found: Trajectory, expected: Trajectory) -> None:
    for name in ("times_s", "positions_m", "orientations_xyzw", "covariances", "floors"):
        mine, theirs = getattr(found, name), getattr(expected, name)
        assert (mine is None) == (theirs is None)
        if mine is not None:
            np.testing.assert_array_equal(mine, theirs)


@pytest.mark.parametrize("freedoms", [3, 6])
def test_what_comes_back_is_what_was_kept(database: Database, freedoms: int) -> None:
    trajectory = poses(freedoms)
    stored = kept(database, trajectory)
    assert (stored.pose_count, stored.failure_count, stored.snapshot_count) == (COUNT, 0, 0)
    assert (stored.first_s, stored.last_s) == (trajectory.times_s[0], trajectory.times_s[-1])
    assert stored.closed_s is not None
    with database.reading() as session:
        assert TrajectoryRepository(session).get(stored.trajectory_id) == stored
        assert session.query(ImportedPosesRow).count() == 3
        assert_same(all_poses(session, stored.trajectory_id), trajectory)
        between = TimeRange(float(trajectory.times_s[5]), float(trajectory.times_s[15]))
        assert_same(all_poses(session, stored.trajectory_id, between), trajectory.take(np.arange(5, 15)))
        assert len(all_poses(session, stored.trajectory_id, TimeRange(0.0, START_S))) == 0
    parts = list(pose_parts(database, stored, TimeRange()))
    assert_same(pose_blobs.joined(parts), trajectory)


@pytest.mark.parametrize("limit", [1, 7, 10, 25, 100])
def test_pages_follow_each_other(database: Database, limit: int) -> None:
    trajectory = poses(6)
    stored = kept(database, trajectory)
    ordinals: list[int] = []
    with database.reading() as session:
        imported, after = ImportedTrajectories(session), None
        while True:
            part = imported.part(stored.trajectory_id, TimeRange(), after, limit)
            ordinals += part.ordinals.tolist()
            after = part.end
            if after is None:
                break
    assert ordinals == list(range(1, COUNT + 1))
