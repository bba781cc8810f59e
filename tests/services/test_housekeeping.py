"""What nobody needs goes, what anybody needs stays, whoever else is at work meanwhile."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from sqlalchemy import delete

from app.services.housekeeping import ORPHAN_GRACE_S, HousekeepingReport, housekeep, look_around
from app.services.photo_removal import remove_unused
from app.services.storage_budget import StorageBudget, StorageLimits
from app.services.surveys import PhotoIntake, Upload
from app.storage.database import Database
from app.storage.kept_snapshots import KeptSnapshot, KeptSnapshotRepository
from app.storage.models import PhotographRow
from app.storage.photo_store import PhotoStore, open_photo_store
from app.storage.records import Keep, KeepingPolicy, Site
from app.storage.sites import SiteRepository
from app.storage.snapshots import Snapshot
from app.storage.surveys import DetectionKey, DetectionRepository, SurveyRepository
from app.storage.trajectories import TrajectoryRepository
from app.vision.photo import PhotoLimits
from tests.object_stores import S3Server
from tests.services.backup_scene import jpeg, sha256_of
from tests.storage.examples import detection, located, photo, site_with_survey, snapshot

RETENTION_S = 100.0
NOTHING = HousekeepingReport(0, 0, 0, 0, 0)


@pytest.fixture(params=["folder", "s3"])
def photos(request: pytest.FixtureRequest, tmp_path: Path) -> PhotoStore:
    if request.param == "folder":
        return open_photo_store(str(tmp_path / "photographs"))
    s3: S3Server = request.getfixturevalue("s3")
    return open_photo_store(s3.new_url())


class House:
    """A site with photographs in its survey, snapshots with pictures, and things that nobody needs."""

    def __init__(self, database: Database, photos: PhotoStore) -> None:
        self.database, self.photos = database, photos
        self.site, self.survey_id = site_with_survey(database)
        self.now_s = time.time()
        self.surveyed = self.put(1)
        self.orphan = self.put(2)
        with database.writing() as session:
            SiteRepository(session).keep(self.site.site_id, KeepingPolicy(Keep.ALL, RETENTION_S))
            SurveyRepository(session).add_photo(self.survey_id, photo("a.jpg", self.surveyed))
            for digest in (self.surveyed, "f" * 64):
                DetectionRepository(session).put(DetectionKey(digest, "default-1", "0" * 64), detection())
        self.expired = self.keep(3, self.now_s - 2 * RETENTION_S)
        self.kept = self.keep(4, self.now_s)

    def put(self, seed: int) -> str:
        data = jpeg(seed)
        self.photos.put(sha256_of(data), data)
        return sha256_of(data)

    def keep(self, seed: int, kept_s: float) -> str:
        digest = self.put(seed)
        with self.database.writing() as session:
            pose = record(session, self.site)
            kept = KeptSnapshot(pose.pose_id, self.site.site_id, digest, 1, kept_s)
            assert KeptSnapshotRepository(session).add(kept)
        return digest

    @property
    def files(self) -> set[str]:
        return {item.name for item in self.photos.photos()}


def record(session: object, site: Site) -> Snapshot:
    trajectories = TrajectoryRepository(session)  # type: ignore[arg-type]
    return trajectories.record(trajectories.default(site.site_id, "phone-1").trajectory_id, snapshot(site, located()))


def test_what_nobody_needs_is_removed_once(database: Database, photos: PhotoStore) -> None:
    house = House(database, photos)
    later_s = house.now_s + 2 * ORPHAN_GRACE_S
    with database.writing() as session:  # a longer time, also for what is there already
        SiteRepository(session).keep(house.site.site_id, KeepingPolicy(Keep.ALL, later_s - house.now_s + RETENTION_S))
    found = look_around(database, photos, later_s)
    assert house.files == {house.surveyed, house.orphan, house.expired, house.kept}
    done = housekeep(database, photos, later_s)
    assert done == found == HousekeepingReport(1, 1, len(jpeg(2)), 1, 0)
    assert house.files == {house.surveyed, house.kept}
    assert housekeep(database, photos, later_s) == look_around(database, photos, later_s) == NOTHING
    with database.reading() as session:
        key = DetectionKey(house.surveyed, "default-1", "0" * 64)
        assert DetectionRepository(session).get(key) is not None


def test_what_has_just_come_is_left_alone(database: Database, photos: PhotoStore) -> None:
    house = House(database, photos)
    assert housekeep(database, photos, house.now_s) == HousekeepingReport(1, 0, 0, 0, 0)
    assert house.files == {house.surveyed, house.orphan, house.kept}


def test_pictures_stay_until_they_are_deleted_when_there_is_no_time(database: Database, photos: PhotoStore) -> None:
    house = House(database, photos)
    with database.writing() as session:
        SiteRepository(session).keep(house.site.site_id, KeepingPolicy(Keep.NONE, None))
    assert housekeep(database, photos, house.now_s + 1e9).expired_snapshots == 0
    assert {house.expired, house.kept} <= house.files


def test_a_picture_that_a_survey_has_too_outlives_its_time(database: Database, photos: PhotoStore) -> None:
    house = House(database, photos)
    with database.writing() as session:
        SurveyRepository(session).add_photo(house.survey_id, photo("b.jpg", house.expired))
    assert housekeep(database, photos, house.now_s).expired_snapshots == 1
    assert house.expired in house.files


def test_a_deleted_site_leaves_no_file(database: Database, photos: PhotoStore) -> None:
    house = House(database, photos)
    with database.writing() as session:
        SiteRepository(session).delete(house.site.site_id)
    housekeep(database, photos, house.now_s + 2 * ORPHAN_GRACE_S)
    assert house.files == set()


def test_only_unused_files_are_removed_on_request(database: Database, photos: PhotoStore) -> None:
    house = House(database, photos)
    assert remove_unused(database, photos, [house.surveyed, house.orphan, house.kept, house.orphan]) == 1
    assert house.files == {house.surveyed, house.expired, house.kept}


async def whole(data: bytes) -> AsyncIterator[bytes]:
    yield data


def test_uploads_and_two_housekeepers_at_once_lose_nothing(database: Database, tmp_path: Path) -> None:
    """The same few photographs come and go all the time, and every file counts as old."""
    photos = open_photo_store(str(tmp_path / "photographs"))
    _, survey_id = site_with_survey(database)
    budget = StorageBudget(database, photos, StorageLimits())
    intake = PhotoIntake(database, photos, PhotoLimits(), budget)
    uploading, faults = threading.Event(), list[BaseException]()
    uploading.set()

    def keep_house() -> None:
        try:
            while uploading.is_set():
                housekeep(database, photos, time.time() + 2 * ORPHAN_GRACE_S)
        except BaseException as error:
            faults.append(error)
            raise

    keepers = [threading.Thread(target=keep_house) for _ in range(2)]
    for keeper in keepers:
        keeper.start()
    try:
        for turn in range(30):
            data = jpeg(turn % 2)
            asyncio.run(intake.take(survey_id, [Upload("a.jpg", whole(data)), Upload("b.jpg", whole(data))]))
            assert photos.read(sha256_of(data)) == data
            with database.writing() as session:
                session.execute(delete(PhotographRow).where(PhotographRow.survey_id == survey_id))
    finally:
        uploading.clear()
        for keeper in keepers:
            keeper.join()
    assert faults == []
