"""kill -9 of the worker, of the service or of both, at each stage of a build: it ends as if nothing had happened."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select

from app.settings import Settings
from app.storage.database import Database
from app.storage.models import DetectionRow, JobRow, TargetMapRow, WorkerRow
from tests.api.serving import Served, room_photos
from tests.databases import PostgresDatabases, migrated
from tests.faults.installation import Installation, wait_until

pytestmark = pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are found in /proc")

# Enough for a map, and two chunks.
FEW = ("IMG_0000.jpg", "IMG_0001.jpg", "IMG_0013.jpg", "IMG_0015.jpg", "IMG_0011.jpg", "IMG_0003.jpg")
SERVICE, WORKER = ("app.cli", "serve"), ("app.cli", "worker")
ADJUSTING = ("network", "adjust", "control", "covariance")


@pytest.fixture
def installation(tmp_path: Path) -> Iterator[Installation]:
    with Installation(Settings(data_dir=tmp_path, locate_workers=1, build_workers=1)) as made:
        yield made


def surveyed(served: Served) -> str:
    """A survey that waits for its build."""
    survey_id = served.new_survey(served.new_site())
    photos = room_photos("survey")
    for name in FEW:
        assert served.put_photo(survey_id, name, photos[name]).status_code == 201
    return survey_id


def begun(served: Served, survey_id: str, **options: Any) -> str:
    answer = served.client.post(f"/surveys/{survey_id}/build", json=options)
    assert answer.status_code == 202, answer.text
    return str(answer.json()["job_id"])


def await_detection(served: Served, job_id: str) -> None:
    """The middle of detection: something is done, something is not."""

    def is_there() -> bool:
        job = served.client.get(f"/jobs/{job_id}").json()
        return job["stage"] == "detect" and 0 < job["done"] < job["total"]

    wait_until(is_there, "nothing was detected")


def await_adjustment(served: Served, job_id: str) -> None:
    wait_until(lambda: served.client.get(f"/jobs/{job_id}").json()["stage"] in ADJUSTING, "nothing was adjusted")


def rows(settings: Settings, *columns: Any) -> list[Any]:
    database = Database(settings.sqlalchemy_url)
    try:
        with database.reading() as session:
            return list(session.execute(select(*columns)))
    finally:
        database.close()


def detections(settings: Settings) -> set[Any]:
    """What is detected, and when: a photograph that is detected twice would have another time."""
    return {tuple(row) for row in rows(settings, DetectionRow.sha256, DetectionRow.created_s)}


def assert_published_once(served: Served, job_id: str, versions: int = 1) -> None:
    job = served.wait(job_id)
    assert job["state"] == "succeeded", job
    assert job["result"]["map_version"] == versions
    published = rows(served.settings, TargetMapRow.job_id)
    assert len(published) == len(set(published)) == versions


def test_a_killed_worker_comes_back_and_goes_on_where_it_was(installation: Installation) -> None:
    with installation.serving() as served:
        survey_id = surveyed(served)
        first = begun(served, survey_id)
        await_detection(served, first)
        installation.kill(*WORKER)
        before = detections(served.settings)
        assert_published_once(served, first)
        assert before
        assert before <= detections(served.settings)
        assert len(detections(served.settings)) == len(FEW)

        second = begun(served, survey_id)
        await_adjustment(served, second)
        installation.kill(*WORKER)
        assert_published_once(served, second, versions=2)
        assert len(detections(served.settings)) == len(FEW)


def test_a_killed_service_leaves_no_process_and_the_next_one_ends_the_build(installation: Installation) -> None:
    with installation.serving() as served:
        job_id = begun(served, surveyed(served))
        await_detection(served, job_id)
        installation.kill(*SERVICE)
        installation.await_end_of_all()
        before = detections(served.settings)
    with installation.serving() as served:
        await_adjustment(served, job_id)
        installation.kill(*SERVICE)
        installation.kill(*WORKER)
        installation.await_end_of_all()
    with installation.serving() as served:
        assert_published_once(served, job_id)
        assert before <= detections(served.settings)
        assert len(detections(served.settings)) == len(FEW)


def test_another_worker_takes_over_on_postgres(tmp_path: Path, postgresql: PostgresDatabases) -> None:
    url = migrated(postgresql.empty())
    settings = Settings(data_dir=tmp_path, database_url=url, locate_workers=1, build_workers=1)
    with Installation(settings) as installation, installation.serving("--no-worker") as served:
        workers = {}
        for _ in range(2):
            pid = installation.start_worker()
            (worker_id,) = signed_up(settings) - set(workers)
            workers[worker_id] = pid
        survey_id = surveyed(served)
        first = begun(served, survey_id)
        await_detection(served, first)
        dead = owner_of(settings, first)
        os.kill(workers.pop(dead), signal.SIGKILL)
        assert_published_once(served, first)
        assert signed_up(settings) == set(workers)

        second = begun(served, survey_id)
        await_adjustment(served, second)
        (last,) = workers.values()
        os.kill(last, signal.SIGTERM)
        wait_until(lambda: not installation.pids(*WORKER), "the worker goes on")
        assert served.client.get(f"/jobs/{second}").json()["state"] == "running"
        installation.start_worker()
        assert_published_once(served, second, versions=2)
        assert strikes(settings)[second] == 0  # who is told to stop was not killed by its job
        assert len(detections(settings)) == len(FEW)
    postgresql.take_back(url)


def signed_up(settings: Settings) -> set[str]:
    return {row.id for row in rows(settings, WorkerRow.id)}


def owner_of(settings: Settings, job_id: str) -> str:
    return next(row.owner for row in rows(settings, JobRow.id, JobRow.owner) if row.id == job_id)


def strikes(settings: Settings) -> dict[str, int]:
    return {row.id: row.strikes for row in rows(settings, JobRow.id, JobRow.strikes)}
