"""The whole story on Postgres: a database without tables, migrated by the command; a site, a build, a pose."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from app.settings import Settings
from tests.api.bad_photos import encoded
from tests.api.serving import ROOM, Served, assert_problem, room_control_points, room_photos, serve
from tests.databases import PostgresDatabases

POSITION_LIMIT_M = 0.03  # as in test_locate
TRUTH = json.loads((ROOM / "locate" / "truth.json").read_text())["shots"][0]
WALL = encoded(np.full((480, 640, 3), 200, dtype=np.uint8), "PNG")
SNAPSHOT_ID = "0190c0de-0000-7000-8000-000000000001"


@pytest.fixture
def url(postgresql: PostgresDatabases) -> Iterator[str]:
    made = postgresql.empty()
    yield made
    postgresql.take_back(made)


def test_tables_that_are_not_there_are_said_in_one_line(
    url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SCATTERMARK_DATABASE_URL", url)
    assert main(["serve", "--port", "0", "--data-dir", str(tmp_path)]) == 1
    assert "run `scattermark migrate`" in capsys.readouterr().err


def test_from_an_empty_database_to_a_pose(
    url: str, tmp_path: Path, snapshot: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SCATTERMARK_DATABASE_URL", url)
    assert main(["migrate"]) == 0
    settings = Settings(data_dir=tmp_path, database_url=url, locate_workers=1, build_workers=2)
    with serve(settings) as served:
        assert served.client.get("/readyz").status_code == 200
        site_id = surveyed_site(served)
        located = served.locate(site_id, snapshot, snapshot_id=SNAPSHOT_ID)
        assert located.status_code == 200, located.text
        answer = located.json()
        assert np.linalg.norm(np.array(answer["position_m"]) - TRUTH["position_m"]) < POSITION_LIMIT_M
        refused = assert_problem(served.locate(site_id, WALL), 422, "not-located")
        assert refused["trajectory_id"] == answer["trajectory_id"]
    with serve(settings, worker=False) as restarted:
        assert restarted.locate(site_id, snapshot, snapshot_id=SNAPSHOT_ID).json() == answer
        assert restarted.client.delete(f"/sites/{site_id}").status_code == 204
        assert_problem(restarted.locate(site_id, snapshot), 404, "not-found")


def surveyed_site(served: Served) -> str:
    site_id = served.new_site()
    assert served.put_control_points(site_id, room_control_points()).status_code == 200
    survey_id = served.new_survey(site_id)
    for name, data in room_photos("survey").items():
        assert served.put_photo(survey_id, name, data).status_code == 201
    job = served.build(survey_id)
    assert job["state"] == "succeeded", job
    return site_id
