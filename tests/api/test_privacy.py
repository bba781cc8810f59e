"""Positions never stay, pictures stay only where a site says so, and what was recorded can be forgotten."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

import numpy as np
import piexif
import pytest

from tests.api.bad_photos import encoded
from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem
from tests.vision.privacy.hiding import Place, exif_block, jpeg_with, preview, segment

WALL = encoded(np.full((480, 640, 3), 200, dtype=np.uint8), "PNG")
PLACE = Place(52.123456, 13.654321)


def with_position(photo: bytes) -> bytes:
    """A photograph as a phone takes it when it is allowed to know where it is."""
    tables = piexif.load(photo)
    tables["GPS"] = PLACE.directory
    tables["1st"], tables["thumbnail"] = {piexif.ImageIFD.Compression: 6}, preview(PLACE)
    return bytes(photo[:2] + segment(0xE1, piexif.dump(tables)) + photo[2:])


@pytest.fixture
def keeping(served: Served, room: SurveyedRoom) -> Iterator[str]:
    """The surveyed site, keeping all pictures until the test ends."""
    site_id = room.site_id
    answer = served.client.patch(f"/sites/{site_id}", json={"keep_snapshots": True, "snapshot_retention_s": 3600})
    assert answer.status_code == 200, answer.text
    yield site_id
    served.client.patch(f"/sites/{site_id}", json={"keep_snapshots": False, "snapshot_retention_s": None})


def test_a_position_is_neither_stored_nor_returned(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    survey_id = served.new_survey(room.site_id)
    sent = with_position(snapshot)
    answer = served.put_photo(survey_id, "hall.jpg", sent)
    assert answer.status_code == 201, answer.text
    assert (answer.json()["sha256"], answer.json()["bytes"]) == (hashlib.sha256(sent).hexdigest(), len(sent))
    assert served.put_photo(survey_id, "hall.jpg", sent).status_code == 200
    (listed,) = served.client.get(f"/surveys/{survey_id}/images").json()["images"]
    assert (listed["sha256"], listed["bytes"]) == (hashlib.sha256(sent).hexdigest(), len(sent))
    assert listed["camera"] == "Google Pixel 2"
    files = [path.read_bytes() for path in served.settings.photographs_dir.rglob("*") if path.is_file()]
    assert not any(trace in data for trace in PLACE.traces for data in files)
    assert_problem(served.put_photo(survey_id, "hall.jpg", snapshot), 409, "conflict")


def test_no_picture_is_kept_unless_the_site_says_so(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    site = served.client.get(f"/sites/{room.site_id}").json()
    assert (site["keep_snapshots"], site["snapshot_retention_s"]) == (False, None)
    pose_id = served.locate(room.site_id, snapshot).json()["pose_id"]
    assert_problem(served.client.get(f"/poses/{pose_id}/image"), 404, "not-found")


def test_a_kept_picture_is_located_from_all_and_shown_without_its_position(
    served: Served, keeping: str, snapshot: bytes
) -> None:
    located = served.locate(keeping, with_position(snapshot), device_id="walker")
    assert located.status_code == 200, located.text
    picture = served.client.get(f"/poses/{located.json()['pose_id']}/image")
    assert (picture.status_code, picture.headers["content-type"]) == (200, "image/jpeg")
    assert "no-store" in picture.headers["cache-control"]
    assert piexif.load(picture.content)["GPS"] == {}
    assert not any(trace in picture.content for trace in PLACE.traces)
    refused = assert_problem(served.locate(keeping, WALL, device_id="walker"), 422, "not-located")
    assert served.client.get(f"/poses/{refused['pose_id']}/image").content == WALL


def test_failures_alone_are_kept_on_request(served: Served, keeping: str, snapshot: bytes) -> None:
    answer = served.client.patch(f"/sites/{keeping}", json={"keep_snapshots": "failures"})
    assert (answer.json()["keep_snapshots"], answer.json()["snapshot_retention_s"]) == ("failures", 3600)
    pose_id = served.locate(keeping, snapshot).json()["pose_id"]
    assert served.client.get(f"/poses/{pose_id}/image").status_code == 404
    refused = served.locate(keeping, WALL).json()
    assert served.client.get(f"/poses/{refused['pose_id']}/image").status_code == 200


def test_a_pose_a_trajectory_and_a_device_can_be_forgotten(served: Served, keeping: str, snapshot: bytes) -> None:
    first, second = (served.locate(keeping, snapshot, device_id="leaver").json() for _ in range(2))
    assert served.client.delete(f"/poses/{first['pose_id']}").status_code == 204
    assert_problem(served.client.delete(f"/poses/{first['pose_id']}"), 404, "not-found")
    assert_problem(served.client.get(f"/poses/{first['pose_id']}/image"), 404, "not-found")
    trajectory = served.client.get(f"/trajectories/{second['trajectory_id']}").json()
    assert (trajectory["pose_count"], len(trajectory["poses"])) == (1, 1)
    assert served.client.delete(f"/trajectories/{second['trajectory_id']}").status_code == 204
    assert_problem(served.client.get(f"/trajectories/{second['trajectory_id']}"), 404, "not-found")
    third = served.locate(keeping, snapshot, device_id="leaver").json()
    assert third["trajectory_id"] != second["trajectory_id"]
    address = f"/sites/{keeping}/snapshots"
    assert served.client.delete(address, params={"device_id": "leaver", "before": "2001-01-01"}).json()["removed"] == 0
    assert served.client.delete(address, params={"device_id": "leaver"}).json() == {"removed": 1}
    assert_problem(served.client.get(f"/poses/{third['pose_id']}/image"), 404, "not-found")
    assert_problem(served.client.delete(address), 422, "invalid-input")


@pytest.mark.parametrize(
    "body",
    [
        {"keep_snapshots": "some"},
        {"keep_snapshots": 1},
        {"snapshot_retention_s": 0},
        {"snapshot_retention_s": -5},
        {"snapshot_retention_s": 1e300},
        {"snapshot_retention_s": "a week"},
    ],
)
def test_what_cannot_be_kept_is_refused(served: Served, room: SurveyedRoom, body: dict[str, object]) -> None:
    assert_problem(served.client.patch(f"/sites/{room.site_id}", json=body), 422, "invalid-input")


def test_a_site_is_made_with_its_wishes(served: Served) -> None:
    site_id = served.new_site(keep_snapshots="failures", snapshot_retention_s=86400)
    site = served.client.get(f"/sites/{site_id}").json()
    assert (site["keep_snapshots"], site["snapshot_retention_s"]) == ("failures", 86400)


def test_a_block_without_position_keeps_a_photograph_as_it_is(served: Served, room: SurveyedRoom) -> None:
    survey_id = served.new_survey(room.site_id)
    sent = jpeg_with(segment(0xE1, exif_block(None, note=b"in the hall")))
    answer = served.put_photo(survey_id, "plain.jpg", sent)
    assert answer.status_code == 201, answer.text
    digest = hashlib.sha256(sent).hexdigest()
    (stored,) = served.settings.photographs_dir.rglob(digest)
    assert stored.read_bytes() == sent
