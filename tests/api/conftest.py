"""One service for all tests of the interface, with the demonstration room surveyed once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from app.settings import Settings
from tests.api.guarding import Guarded, serve_guarded
from tests.api.serving import Served, room_control_points, room_photos, serve


@dataclass(frozen=True)
class SurveyedRoom:
    """A site with a map."""

    site_id: str
    survey_id: str
    job: dict[str, Any]


@pytest.fixture(scope="session")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    settings = Settings(data_dir=tmp_path_factory.mktemp("served"), locate_workers=2, build_workers=2)
    with serve(settings) as running:
        yield running


@pytest.fixture(scope="session")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Guarded]:
    """A service that asks for keys."""
    with serve_guarded(tmp_path_factory.mktemp("guarded")) as running:
        yield running


@pytest.fixture(scope="session")
def room(served: Served) -> SurveyedRoom:
    site_id = served.new_site()
    assert served.put_control_points(site_id, room_control_points()).status_code == 200
    survey_id = served.new_survey(site_id, note="the demonstration room", device_id="surveyor")
    for name, data in room_photos("survey").items():
        assert served.put_photo(survey_id, name, data).status_code == 201
    job = served.build(survey_id)
    assert job["state"] == "succeeded", job
    return SurveyedRoom(site_id, survey_id, job)


@pytest.fixture(scope="session")
def snapshot() -> bytes:
    """A snapshot that can be located."""
    return room_photos("locate")["IMG_0000.jpg"]


@pytest.fixture
def data_files(served: Served) -> set[Path]:
    """Photographs on disk before the test."""
    return {path for path in served.settings.photographs_dir.rglob("*") if path.is_file()}
