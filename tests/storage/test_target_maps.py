from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from app.errors import Conflict, NotFound
from app.geometry.target_map import TargetMap
from app.storage.cameras import CameraRepository
from app.storage.database import Database
from app.storage.paging import PageRequest, cursor_of
from app.storage.sites import SiteRepository
from app.storage.target_maps import TargetMapRepository
from tests.storage import examples


def assert_same_map(mine: TargetMap, theirs: TargetMap) -> None:
    assert (mine.code_family, mine.u_m) == (theirs.code_family, theirs.u_m)
    for entry in fields(mine.datum):
        np.testing.assert_array_equal(getattr(mine.datum, entry.name), getattr(theirs.datum, entry.name))
    assert mine.by_code.keys() == theirs.by_code.keys()
    for code, target in theirs.by_code.items():
        found = mine.by_code[code]
        np.testing.assert_array_equal(found.site_from_target.rotation, target.site_from_target.rotation)
        np.testing.assert_array_equal(found.site_from_target.position_m, target.site_from_target.position_m)
        np.testing.assert_array_equal(found.dots_m, target.dots_m)
        np.testing.assert_array_equal(found.covariance, target.covariance)
        assert (found.rays, found.rms_px) == (target.rays, target.rms_px)


def publish(database: Database, site_id: str, survey_id: str, job_id: str) -> int:
    with database.writing() as session:
        return TargetMapRepository(session).publish(site_id, examples.publication(job_id, survey_id))


def test_a_map_comes_back_to_the_last_bit(database: Database) -> None:
    site, survey_id = examples.site_with_survey(database)
    version = publish(database, site.site_id, survey_id, "job-1")
    with database.reading() as session:
        maps = TargetMapRepository(session)
        assert_same_map(maps.load(site.site_id, version), examples.target_map())
        assert maps.report(site.site_id, version) == {"sigma0": 0.97}
        posed, lost = maps.photos(site.site_id, version)
        assert posed.site_from_cam is not None
        np.testing.assert_array_equal(posed.site_from_cam.rotation, examples.pose(8).rotation)
        np.testing.assert_array_equal(posed.covariance, examples.covariance(6, 8))
        assert (posed.name, posed.camera_key, posed.rms_px) == ("a.jpg", examples.IDENTITY.key, 0.06)
        assert (posed.target_count, posed.codes) == (3, (101, 389, 420))
        assert (lost.name, lost.site_from_cam, lost.codes) == ("b.jpg", None, None)
        assert lost.reason == "sees no target that another photograph sees"
        (camera,) = CameraRepository(session).of_map(site.site_id, version)
        assert (camera.identity, camera.device_id) == (examples.IDENTITY, "phone-1")


def test_photographs_come_page_by_page(database: Database) -> None:
    site, survey_id = examples.site_with_survey(database)
    version = publish(database, site.site_id, survey_id, "job-1")
    with database.reading() as session:
        maps = TargetMapRepository(session)
        first = maps.photo_page(site.site_id, version, PageRequest(1))
        second = maps.photo_page(site.site_id, version, PageRequest(1, first.next_cursor))
        assert [photo.name for photo in (*first.items, *second.items)] == ["a.jpg", "b.jpg"]
        assert second.next_cursor is None
        with pytest.raises(NotFound, match="no target map version 7"):
            maps.photo_page(site.site_id, 7, PageRequest())


def test_versions_count_up_and_one_build_publishes_once(database: Database) -> None:
    site, survey_id = examples.site_with_survey(database)
    numbers = [publish(database, site.site_id, survey_id, job_id) for job_id in ("job-1", "job-2", "job-1", "job-3")]
    assert numbers == [1, 2, 1, 3]
    with database.reading() as session:
        first = TargetMapRepository(session).versions(site.site_id, PageRequest(2))
        rest = TargetMapRepository(session).versions(site.site_id, PageRequest(2, first.next_cursor))
        beyond = TargetMapRepository(session).versions(site.site_id, PageRequest(2, cursor_of(str(10**30))))
    assert [version.version for version in first.items + rest.items] == [1, 2, 3]
    assert beyond.items == ()


def test_a_version_is_active_only_when_told(database: Database) -> None:
    site, survey_id = examples.site_with_survey(database)
    for job_id in ("job-1", "job-2"):
        publish(database, site.site_id, survey_id, job_id)
    with database.writing() as session:
        maps = TargetMapRepository(session)
        with pytest.raises(Conflict, match="no target map yet"):
            maps.version(site.site_id, None)
        maps.activate(site.site_id, 2)
    with database.writing() as session:
        maps = TargetMapRepository(session)
        assert SiteRepository(session).get(site.site_id).active_version == 2
        assert maps.version(site.site_id, None).version == 2
        assert not maps.version(site.site_id, 1).active
        with pytest.raises(NotFound, match="no target map version 9"):
            maps.activate(site.site_id, 9)
