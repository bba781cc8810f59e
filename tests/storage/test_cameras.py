from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import NotFound
from app.storage.cameras import CameraRepository
from app.storage.database import Database
from app.storage.paging import PageRequest
from app.storage.records import NewCamera
from tests.storage import examples


def test_a_camera_comes_back_to_the_last_bit(database: Database) -> None:
    with database.writing() as session:
        made = CameraRepository(session).add(NewCamera(examples.IDENTITY, examples.calibrated(), "phone-1"), None, None)
    with database.reading() as session:
        back = CameraRepository(session).get(made.camera_id)
        with pytest.raises(NotFound, match="GET /cameras"):
            CameraRepository(session).get("nowhere")
    assert (back.identity, back.device_id, back.calibrated.source) == (examples.IDENTITY, "phone-1", "survey")
    np.testing.assert_array_equal(back.calibrated.camera.intrinsics, examples.calibrated().camera.intrinsics)
    np.testing.assert_array_equal(back.calibrated.covariance, examples.calibrated().covariance)


def test_candidates_are_the_newest_of_the_site_and_of_the_device(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    other, _ = examples.site_with_survey(database)
    wide = replace(examples.IDENTITY, focal_mm=2.2)
    with database.writing() as session:
        cameras = CameraRepository(session)

        def add(seed: int, site_id: str, device_id: str | None, identity: object = examples.IDENTITY) -> str:
            camera = NewCamera(identity, examples.calibrated(seed=seed), device_id)  # type: ignore[arg-type]
            return cameras.add(camera, site_id, seed).camera_id

        add(1, site.site_id, None)
        newest = add(2, site.site_id, None)
        another_lens = add(3, site.site_id, None, wide)
        device = add(4, other.site_id, "phone-1")
        add(5, other.site_id, "phone-2")
        found = {camera.camera_id for camera in cameras.candidates(site.site_id, "phone-1")}
        assert found == {newest, another_lens, device}
        assert {camera.camera_id for camera in cameras.candidates(site.site_id, None)} == {newest, another_lens}


def test_pages_are_of_one_site_or_device_when_named(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        cameras = CameraRepository(session)
        mine = cameras.add(NewCamera(examples.IDENTITY, examples.calibrated(), "phone-1"), site.site_id, 1).camera_id
        theirs = cameras.add(NewCamera(examples.IDENTITY, examples.calibrated(), "phone-2"), None, None).camera_id

        def ids(site_id: str | None, device_id: str | None) -> set[str]:
            return {camera.camera_id for camera in cameras.page(site_id, device_id, PageRequest()).items}

        assert ids(None, None) == {mine, theirs}
        assert ids(site.site_id, None) == {mine}
        assert ids(None, "phone-2") == {theirs}
        first = cameras.page(None, None, PageRequest(1))
        assert len(cameras.page(None, None, PageRequest(1, first.next_cursor)).items) == 1
