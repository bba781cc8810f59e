"""Room for photographs: what is used, what is left, what happens when there is none."""

from __future__ import annotations

import base64
import hashlib
import os
from pathlib import Path

import pytest

from app.services.storage_budget import StorageBudget, StorageLimits
from tests.api.serving import Served, assert_problem, room_photos
from tests.services.backup_scene import jpeg

PHOTO = jpeg(40)
DIGEST = hashlib.sha256(PHOTO).digest()


@pytest.fixture
def survey_id(served: Served) -> str:
    return served.new_survey(served.new_site())


@pytest.fixture
def limited(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    """A quota that is used up."""
    budget = StorageBudget(served.services.database, served.services.intake.store, StorageLimits(quota_bytes=1))
    monkeypatch.setattr(served.services.intake, "_budget", budget)


def files(served: Served) -> set[Path]:
    return {path for path in served.settings.photographs_dir.rglob("*") if path.is_file()}


def test_what_is_used_is_shown_by_site(served: Served, survey_id: str) -> None:
    before = served.client.get("/storage").json()
    assert (before["quota_bytes"], before["min_free_bytes"]) == (None, served.settings.min_free_bytes)
    assert before["free_bytes"] > 0
    data = jpeg(41)
    for name in ("a.jpg", "b.jpg"):
        served.put_photo(survey_id, name, data)
    after = served.client.get("/storage").json()
    assert after["used_bytes"] - before["used_bytes"] == len(data)
    site_id = served.client.get(f"/surveys/{survey_id}").json()["site_id"]
    (site,) = [site for site in after["sites"] if site["site_id"] == site_id]
    assert (site["photographs"], site["photographs_bytes"], site["kept_snapshots"]) == (2, 2 * len(data), 0)


@pytest.mark.usefixtures("limited")
def test_over_the_quota_nothing_is_written(served: Served, survey_id: str) -> None:
    before = files(served)
    problem = assert_problem(served.put_photo(survey_id, "a.jpg", PHOTO), 507, "insufficient-storage")
    assert problem["quota_bytes"] == 1
    images = [("images", ("a.jpg", PHOTO)), ("images", ("b.jpg", jpeg(42)))]
    assert_problem(served.client.post(f"/surveys/{survey_id}/images", files=images), 507, "insufficient-storage")
    assert files(served) == before
    assert served.client.get(f"/surveys/{survey_id}/images").json()["images"] == []


@pytest.mark.parametrize(
    ("step", "seed"),
    [("os.fsync", 43), ("pathlib.Path.replace", 44), ("tempfile.mkstemp", 45), ("tempfile.TemporaryFile", 47)],
)
def test_a_disk_that_fills_up_leaves_nothing_half_written(
    served: Served, survey_id: str, step: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    before = files(served)
    photo = jpeg(seed)
    with monkeypatch.context() as patch:
        patch.setattr(step, full)
        assert_problem(served.put_photo(survey_id, "a.jpg", photo), 507, "insufficient-storage")
    assert files(served) == before
    assert served.put_photo(survey_id, "a.jpg", photo).status_code == 201


def test_a_form_that_finds_the_disk_full_is_told_so(
    served: Served, survey_id: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    photos = [("images", (name, data)) for name, data in room_photos("survey").items()]
    with monkeypatch.context() as patch:
        patch.setattr("starlette.formparsers.SpooledTemporaryFile.write", full)
        problem = assert_problem(
            served.client.post(f"/surveys/{survey_id}/images", files=photos), 507, "insufficient-storage"
        )
    assert "TMPDIR" in problem["detail"]
    assert served.client.get(f"/surveys/{survey_id}/images").json()["images"] == []


def test_a_store_that_is_away_is_said_so(served: Served, survey_id: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise OSError(5, "Input/output error")

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", broken)
        answer = served.put_photo(survey_id, "a.jpg", jpeg(46))
    assert_problem(answer, 503, "storage-unavailable")
    assert int(answer.headers["retry-after"]) > 0


@pytest.mark.parametrize(
    ("headers", "query"),
    [
        ({"Content-Digest": f"sha-256=:{base64.b64encode(DIGEST).decode()}:"}, {}),
        ({"Content-Digest": f"sha-512=:AAAA:, sha-256=:{base64.b64encode(DIGEST).decode()}:"}, {}),
        ({}, {"sha256": DIGEST.hex().upper()}),
        ({"Content-Digest": "sha-512=:AAAA:"}, {}),
    ],
    ids=["header", "of-two", "query", "other-algorithm"],
)
def test_bytes_that_were_announced_are_taken(
    served: Served, survey_id: str, headers: dict[str, str], query: dict[str, str]
) -> None:
    address = f"/surveys/{survey_id}/images/a.jpg"
    assert served.client.put(address, content=PHOTO, headers=headers, params=query).status_code == 201


OTHER = hashlib.sha256(b"other bytes").digest()


@pytest.mark.parametrize(
    ("headers", "query", "kind"),
    [
        ({"Content-Digest": f"sha-256=:{base64.b64encode(OTHER).decode()}:"}, {}, "digest-mismatch"),
        ({}, {"sha256": OTHER.hex()}, "digest-mismatch"),
        (
            {"Content-Digest": f"sha-256=:{base64.b64encode(DIGEST).decode()}:"},
            {"sha256": OTHER.hex()},
            "invalid-input",
        ),
        ({"Content-Digest": "sha-256=abc"}, {}, "invalid-input"),
        ({"Content-Digest": "sha-256=:AAAA:"}, {}, "invalid-input"),
        ({"Content-Digest": "sha-256=:A:"}, {}, "invalid-input"),
        ({}, {"sha256": "abc"}, "invalid-input"),
    ],
)
def test_bytes_that_were_not_announced_are_refused(
    served: Served, survey_id: str, headers: dict[str, str], query: dict[str, str], kind: str
) -> None:
    before = files(served)
    address = f"/surveys/{survey_id}/images/a.jpg"
    assert_problem(served.client.put(address, content=PHOTO, headers=headers, params=query), 422, kind)
    assert files(served) == before
