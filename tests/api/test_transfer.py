"""A backup of a running service and an export of a site, each restored into another service that then locates alike."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.services.backup import back_up
from app.services.backup_restore import Target, restore
from app.settings import Settings
from app.storage.database import Database
from app.storage.photo_store import open_photo_store
from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem, room_photos, serve
from tests.databases import Databases

ZIP = "application/zip"
NOT_THE_SAME = ("pose_id", "trajectory_id", "timing_ms", "captured_at", "site_id")
CHUNK_BYTES = 2**16
PATIENCE_S = 30.0


def quiet(_stage: str, _done: int, _total: int) -> None:
    """Nobody listens."""


def located(served: Served, site_id: str, image: bytes) -> dict[str, Any]:
    """What is answered for a snapshot, without what is other each time."""
    answer = served.locate(site_id, image)
    assert answer.status_code == 200, answer.text
    return {name: value for name, value in answer.json().items() if name not in NOT_THE_SAME}


def targets(served: Served, site_id: str) -> dict[str, Any]:
    answer = served.client.get(f"/sites/{site_id}/targets")
    assert answer.status_code == 200, answer.text
    return {name: value for name, value in answer.json().items() if name != "site_id"}


@pytest.fixture(scope="module")
def archive(served: Served, room: SurveyedRoom) -> bytes:
    with served.client.stream("GET", f"/sites/{room.site_id}/export") as answer:
        assert answer.status_code == 200
        assert answer.headers["content-type"] == ZIP
        assert room.site_id in answer.headers["content-disposition"]
        return b"".join(answer.iter_bytes())


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def restored(
    request: pytest.FixtureRequest, served: Served, room: SurveyedRoom, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Served]:
    """Another service, on either database, with what a backup of the running one held."""
    folder = tmp_path_factory.mktemp("restored")
    back_up(served.services.database, open_photo_store(served.settings.photographs_location), folder / "b.zip", quiet)
    kind: Databases = request.getfixturevalue(request.param)
    settings = Settings(data_dir=folder / "data", database_url=kind.empty(), locate_workers=1, build_workers=1)
    settings.data_dir.mkdir()
    database = Database(settings.sqlalchemy_url)
    restore(folder / "b.zip", Target(database, open_photo_store(settings.photographs_location)), quiet)
    database.close()
    with serve(settings, worker=False) as running:
        yield running
    kind.take_back(settings.database_url)
    assert room.site_id


def test_a_restored_service_locates_alike(
    served: Served, restored: Served, room: SurveyedRoom, snapshot: bytes
) -> None:
    assert targets(restored, room.site_id) == targets(served, room.site_id)
    assert located(restored, room.site_id, snapshot) == located(served, room.site_id, snapshot)
    names = {photo["name"] for photo in restored.client.get(f"/surveys/{room.survey_id}/images").json()["images"]}
    assert names == set(room_photos("survey"))


def photographs(service: Served, site_id: str) -> set[str]:
    """Digests of all that was uploaded to any of a site's surveys."""
    surveys = service.client.get(f"/sites/{site_id}/surveys").json()["surveys"]
    lists = [service.client.get(f"/surveys/{survey['survey_id']}/images").json()["images"] for survey in surveys]
    return {photo["sha256"] for listed in lists for photo in listed}


def test_an_imported_site_locates_alike(
    served: Served, restored: Served, room: SurveyedRoom, archive: bytes, snapshot: bytes
) -> None:
    refused = assert_problem(restored.client.post("/sites/import", content=archive), 409, "conflict")
    assert refused["site_id"] == room.site_id
    answer = restored.client.post("/sites/import?as_new=true", content=archive)
    assert answer.status_code == 201, answer.text
    told = answer.json()
    assert told["site_id"] != room.site_id
    assert (told["photographs"], told["left_out"]) == (len(photographs(served, room.site_id)), [])
    assert targets(restored, told["site_id"]) == targets(served, room.site_id)
    assert located(restored, told["site_id"], snapshot) == located(served, room.site_id, snapshot)
    assert restored.client.get(f"/sites/{told['site_id']}/report").status_code == 200
    entries = restored.client.get("/audit", params={"site_id": told["site_id"]}).json()
    assert "POST /sites/import" in str(entries)
    assert restored.client.delete(f"/sites/{told['site_id']}").status_code == 204


def test_an_export_is_refused_before_it_begins(served: Served) -> None:
    assert_problem(served.client.get("/sites/nowhere/export"), 404, "not-found")


@pytest.mark.parametrize("body", [b"", b"a letter to somebody", b"PK\x05\x06" + bytes(18)])
def test_what_is_no_archive(served: Served, body: bytes) -> None:
    assert_problem(served.client.post("/sites/import", content=body), 422, "bad-archive")


def test_a_damaged_archive_leaves_nothing(restored: Served, archive: bytes) -> None:
    sites = restored.client.get("/sites").json()
    middle = len(archive) // 2
    damaged = archive[:middle] + bytes([archive[middle] ^ 1]) + archive[middle + 1 :]
    assert_problem(restored.client.post("/sites/import?as_new=true", content=damaged), 422, "bad-archive")
    assert_problem(restored.client.post("/sites/import?as_new=true", content=archive[:-9]), 422, "bad-archive")
    assert restored.client.get("/sites").json() == sites
    assert leftovers(restored) == []


def test_an_upload_that_breaks_off_leaves_nothing(restored: Served, archive: bytes) -> None:
    def half() -> Iterator[bytes]:
        yield archive[:CHUNK_BYTES]
        raise ConnectionError("the cable was pulled")

    with pytest.raises((ConnectionError, httpx.HTTPError)):
        restored.client.post("/sites/import?as_new=true", content=half())
    assert leftovers(restored) == []
    assert restored.client.get("/healthz").status_code == 200


def test_a_reader_that_leaves_frees_its_place(served: Served, room: SurveyedRoom) -> None:
    """More than may be under way at once, one after the other and each broken off."""
    for _ in range(4):
        with served.client.stream("GET", f"/sites/{room.site_id}/export") as answer:
            assert answer.status_code in (200, 503)
            next(answer.iter_bytes(CHUNK_BYTES))
    deadline_s = time.monotonic() + PATIENCE_S
    while served.client.get(f"/sites/{room.site_id}/export").status_code == 503:
        assert time.monotonic() < deadline_s, "no place becomes free"
        time.sleep(0.05)


def leftovers(served: Served) -> list[Path]:
    return list(served.settings.data_dir.glob("import-*"))
