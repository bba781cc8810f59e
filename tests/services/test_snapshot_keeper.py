"""Pictures of snapshots: kept when a site wants them, without position, and never at the pose's cost."""

from __future__ import annotations

import asyncio
import logging
from pathlib import Path

import pytest

from app.errors import NotFound
from app.services.snapshot_keeper import SnapshotKeeper
from app.services.storage_budget import StorageBudget, StorageLimits
from app.storage.database import Database
from app.storage.photo_store import PhotoStore, open_photo_store
from app.storage.records import Keep, Site
from app.storage.snapshot_removal import SnapshotRemoval
from app.storage.snapshots import Located, NotFoundPose, Snapshot
from app.storage.trajectories import TrajectoryRepository
from tests.storage.examples import REFUSED, located, site_with_survey, snapshot
from tests.vision.privacy import hiding
from tests.vision.privacy.hiding import Place, exif_block, jpeg_with, segment

PICTURE = hiding.saved("PNG")


@pytest.fixture
def photos(tmp_path: Path) -> PhotoStore:
    return open_photo_store(str(tmp_path / "photographs"))


@pytest.fixture
def site(database: Database) -> Site:
    return site_with_survey(database)[0]


def keeper(database: Database, photos: PhotoStore, quota_bytes: int = 0) -> SnapshotKeeper:
    return SnapshotKeeper(database, photos, StorageBudget(database, photos, StorageLimits(quota_bytes)))


def recorded(database: Database, site: Site, outcome: Located | NotFoundPose) -> Snapshot:
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        trajectory_id = trajectories.default(site.site_id, "phone-1").trajectory_id
        return trajectories.record(trajectory_id, snapshot(site, outcome))


@pytest.mark.parametrize(
    ("keep", "of_located", "of_refused"),
    [(Keep.NONE, False, False), (Keep.FAILURES, False, True), (Keep.ALL, True, True)],
)
def test_a_site_says_which_pictures_are_kept(
    database: Database, photos: PhotoStore, site: Site, keep: Keep, of_located: bool, of_refused: bool
) -> None:
    keeping = keeper(database, photos)
    for outcome, wanted in ((located(), of_located), (REFUSED, of_refused)):
        pose = recorded(database, site, outcome)
        asyncio.run(keeping.keep(keep, pose, PICTURE))
        if wanted:
            assert (keeping.picture(pose.pose_id).data, keeping.picture(pose.pose_id).format) == (PICTURE, "PNG")
        else:
            with pytest.raises(NotFound, match="no picture is kept"):
                keeping.picture(pose.pose_id)
    assert len(list(photos.photos())) == int(of_located or of_refused)


def test_a_kept_picture_has_no_position(database: Database, photos: PhotoStore, site: Site) -> None:
    place = Place(52.123456, 13.654321)
    keeping, pose = keeper(database, photos), recorded(database, site, located())
    asyncio.run(keeping.keep(Keep.ALL, pose, jpeg_with(segment(0xE1, exif_block(place)))))
    picture = keeping.picture(pose.pose_id)
    assert picture.format == "JPEG"
    assert not any(trace in picture.data for trace in place.traces)


def test_a_picture_that_cannot_be_kept_is_told_to_the_log(
    database: Database, photos: PhotoStore, site: Site, caplog: pytest.LogCaptureFixture
) -> None:
    keeping, pose = keeper(database, photos, quota_bytes=1), recorded(database, site, located())
    with caplog.at_level(logging.WARNING):
        asyncio.run(keeping.keep(Keep.ALL, pose, PICTURE))
    (message,) = [record.getMessage() for record in caplog.records]
    assert pose.pose_id in message and "SCATTERMARK_QUOTA_BYTES" in message
    assert list(photos.photos()) == []


def test_of_a_pose_that_was_removed_meanwhile_nothing_is_kept(
    database: Database, photos: PhotoStore, site: Site
) -> None:
    keeping, pose = keeper(database, photos), recorded(database, site, located())
    with database.writing() as session:
        SnapshotRemoval(session).pose(pose.pose_id)
    asyncio.run(keeping.keep(Keep.ALL, pose, PICTURE))
    with pytest.raises(NotFound):
        keeping.picture(pose.pose_id)
