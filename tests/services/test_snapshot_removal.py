"""What is removed is gone with its pictures; totals, pages and live streams follow."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from pathlib import Path

import pytest

from app.errors import InvalidInput, NotFound
from app.services.snapshot_removal import SnapshotEraser
from app.services.trajectory_bell import TrajectoryBell
from app.services.trajectory_events import watch_trajectory
from app.storage import snapshot_removal
from app.storage.database import Database
from app.storage.kept_snapshots import KeptSnapshot, KeptSnapshotRepository
from app.storage.photo_store import PhotoStore, open_photo_store
from app.storage.snapshot_removal import SnapshotFilter
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import StoredTrajectory, TimeRange, TrajectoryPart
from app.storage.trajectory_queries import TrajectoryQueries
from tests.services.backup_scene import jpeg, sha256_of
from tests.storage.walks import DEVICE, START_S, Step, add_steps, add_walk, new_site

STEPS = (Step(5.0, (5.0, 1.0, 1.5)), Step(1.0), Step(2.0, reason="ambiguous"), Step(3.0, (1.0, 1.0, 1.0)), Step(4.0))


class Walk:
    """A trajectory, each of its snapshots with a picture."""

    def __init__(self, database: Database, photos: PhotoStore, steps: Sequence[Step] = STEPS) -> None:
        self.database, self.photos = database, photos
        self.site_id = new_site(database)
        self.trajectory_id = add_walk(database, self.site_id, steps)
        self.pose_ids = self.ids()
        for seed, pose_id in enumerate(self.pose_ids):
            self.keep(pose_id, seed)

    def ids(self) -> list[str]:
        part = self.part()
        labels = [*part.labels, *(failure.label for failure in part.failures)]
        return [label.pose_id for label in sorted(labels, key=lambda label: label.ordinal)]

    def keep(self, pose_id: str, seed: int) -> None:
        data = jpeg(seed)
        self.photos.put(sha256_of(data), data)
        with self.database.writing() as session:
            kept = KeptSnapshot(pose_id, self.site_id, sha256_of(data), len(data), START_S)
            assert KeptSnapshotRepository(session).add(kept)

    def part(self) -> TrajectoryPart:
        with self.database.reading() as session:
            return TrajectoryQueries(session).part(self.trajectory_id, TimeRange(), None, 100)

    def stored(self) -> StoredTrajectory:
        with self.database.reading() as session:
            return TrajectoryRepository(session).get(self.trajectory_id)

    @property
    def pictures(self) -> int:
        return len(list(self.photos.photos()))


@pytest.fixture
def walk(database: Database, tmp_path: Path) -> Walk:
    return Walk(database, open_photo_store(str(tmp_path / "photographs")))


@pytest.fixture
def eraser(walk: Walk) -> SnapshotEraser:
    return SnapshotEraser(walk.database, walk.photos)


def test_a_pose_is_removed_with_its_picture(walk: Walk, eraser: SnapshotEraser) -> None:
    before = walk.stored()
    eraser.remove_pose(walk.pose_ids[0])
    after = walk.stored()
    assert (before.pose_count, after.pose_count, after.snapshot_count) == (2, 1, 5)
    assert after.failures == before.failures
    assert (after.first_s, after.last_s) == (START_S + 1.0, START_S + 4.0)  # it was the latest
    assert len(walk.part().labels) == 1
    assert walk.pictures == 4
    with pytest.raises(NotFound, match="no pose"):
        eraser.remove_pose(walk.pose_ids[0])


def test_failures_are_counted_down(walk: Walk, eraser: SnapshotEraser) -> None:
    assert walk.stored().failures == (("ambiguous", 1), ("no-targets", 2))
    eraser.remove_pose(walk.pose_ids[2])
    eraser.remove_pose(walk.pose_ids[1])
    assert walk.stored().failures == (("no-targets", 1),)
    assert walk.stored().pose_count == 2


def test_ordinals_are_never_given_twice(walk: Walk, eraser: SnapshotEraser) -> None:
    eraser.remove_pose(walk.pose_ids[-1])
    add_steps(walk.database, walk.trajectory_id, walk.site_id, [Step(9.0)])
    assert [failure.label.ordinal for failure in walk.part().failures] == [2, 3, 6]
    assert walk.stored().failure_count == 3


def test_a_stream_passes_over_what_was_removed(
    walk: Walk, eraser: SnapshotEraser, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.services.trajectory_events.SNAPSHOTS_AT_A_TIME", 2)
    for pose_id in walk.pose_ids[1:4]:
        eraser.remove_pose(pose_id)
    with walk.database.writing() as session:
        TrajectoryRepository(session).close(walk.trajectory_id)

    async def ordinals() -> list[int]:
        found: list[int] = []
        async for arrivals in watch_trajectory(walk.database, TrajectoryBell(), walk.trajectory_id, 0):
            labels = [*arrivals.part.labels, *(failure.label for failure in arrivals.part.failures)]
            found += [label.ordinal for label in labels]
        return found

    assert asyncio.run(ordinals()) == [1, 5]


def test_a_trajectory_is_removed_whole(walk: Walk, eraser: SnapshotEraser, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(snapshot_removal, "REMOVED_AT_A_TIME", 2)
    eraser.remove_trajectory(walk.trajectory_id)
    with pytest.raises(NotFound, match="no trajectory"):
        walk.stored()
    assert walk.pictures == 0
    with pytest.raises(NotFound, match="no trajectory"):
        eraser.remove_trajectory(walk.trajectory_id)


def test_a_device_is_forgotten_whole(walk: Walk, eraser: SnapshotEraser, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(snapshot_removal, "REMOVED_AT_A_TIME", 2)
    assert eraser.remove_snapshots(SnapshotFilter(walk.site_id, "another")) == 0
    assert eraser.remove_snapshots(SnapshotFilter(walk.site_id, DEVICE)) == 5
    with pytest.raises(NotFound):
        walk.stored()
    assert walk.pictures == 0


def test_what_is_old_is_removed_and_the_rest_stays(walk: Walk, eraser: SnapshotEraser) -> None:
    assert eraser.remove_snapshots(SnapshotFilter(walk.site_id, DEVICE, START_S + 3.0)) == 2
    assert eraser.remove_snapshots(SnapshotFilter(walk.site_id, before_s=START_S + 4.0)) == 1
    assert (walk.stored().pose_count, walk.stored().failure_count, walk.stored().removed_count) == (1, 1, 3)
    assert eraser.remove_snapshots(SnapshotFilter(walk.site_id, before_s=START_S + 100.0)) == 2
    empty = walk.stored()  # a trajectory that is open may get more
    assert (empty.pose_count, empty.failures, empty.first_s, empty.last_s) == (0, (), None, None)
    assert walk.pictures == 0


def test_a_picture_that_another_pose_has_too_stays(walk: Walk, eraser: SnapshotEraser) -> None:
    add_steps(walk.database, walk.trajectory_id, walk.site_id, [Step(9.0)])
    twin = walk.ids()[-1]
    walk.keep(twin, 0)
    eraser.remove_pose(walk.pose_ids[0])
    assert walk.pictures == 5
    eraser.remove_pose(twin)
    assert walk.pictures == 4


def test_all_of_a_site_is_not_removed_by_leaving_everything_out(walk: Walk, eraser: SnapshotEraser) -> None:
    with pytest.raises(InvalidInput, match="name device_id"):
        eraser.remove_snapshots(SnapshotFilter(walk.site_id))
    with pytest.raises(NotFound, match="no site"):
        eraser.remove_snapshots(SnapshotFilter("nowhere", DEVICE))
