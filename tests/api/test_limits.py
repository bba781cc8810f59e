"""A full server, a slow snapshot, a dying worker: one request pays, with a problem that says when to come back."""

from __future__ import annotations

import io
import os
import signal
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import httpx
import pytest
from PIL import Image

from app.settings import Settings
from app.storage.models import SnapshotRow
from app.storage.target_maps import TargetMapRepository
from tests.api.serving import Served, assert_problem, serve
from tests.storage.examples import publication

CROWD = 6
LARGE_PX = (6000, 4000)  # tenths of a second of decoding: long enough to meet the worker at it
ANSWER_S = 30.0


def large_photo() -> bytes:
    """A PNG of 24 megapixels that shows nothing."""
    buffer = io.BytesIO()
    Image.new("RGB", LARGE_PX, (90, 100, 110)).save(buffer, "PNG", compress_level=1)
    return buffer.getvalue()


LARGE = large_photo()


def site_with_map(served: Served) -> str:
    """A site with a map that no survey made."""
    site_id = served.new_site()
    survey_id = served.new_survey(site_id)
    with served.services.database.writing() as session:
        maps = TargetMapRepository(session)
        maps.activate(site_id, maps.publish(site_id, publication(site_id, survey_id)))
    return site_id


@pytest.fixture(scope="module")
def narrow(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """One worker and no queue."""
    folder = tmp_path_factory.mktemp("narrow")
    with serve(Settings(data_dir=folder, locate_workers=1, build_workers=1, queue_depth=0)) as running:
        yield running


def locate_alone(served: Served, site_id: str) -> httpx.Response:
    return httpx.post(
        served.client.base_url.join("/locate"), params={"site_id": site_id}, content=LARGE, timeout=ANSWER_S
    )


def test_a_full_server_says_when_to_come_back(narrow: Served) -> None:
    site_id = site_with_map(narrow)
    with ThreadPoolExecutor(CROWD) as crowd:
        answers = list(crowd.map(lambda _: locate_alone(narrow, site_id), range(CROWD)))
    refused = [answer for answer in answers if answer.status_code == 503]
    answered = [answer for answer in answers if answer.status_code == 422]
    assert len(refused) + len(answered) == CROWD
    assert refused
    assert answered
    for answer in refused:
        problem = assert_problem(answer, 503, "server-full")
        assert int(answer.headers["Retry-After"]) == problem["retry_after_s"] >= 1
    assert_problem(locate_alone(narrow, site_id), 422, "not-located")


def test_a_dying_worker_costs_one_request(narrow: Served) -> None:
    site_id = site_with_map(narrow)
    answers: list[httpx.Response] = []
    request = threading.Thread(target=lambda: answers.append(locate_alone(narrow, site_id)))
    pool = narrow.services.locator._pool
    (pid,) = pool.pids
    request.start()
    deadline_s = time.monotonic() + ANSWER_S
    while not pool.in_flight and time.monotonic() < deadline_s:  # type: ignore[attr-defined]
        time.sleep(0.001)
    time.sleep(0.05)  # into the decoding
    os.kill(pid, signal.SIGKILL)
    request.join()
    assert_problem(answers[0], 500, "worker-crashed")
    assert_problem(locate_alone(narrow, site_id), 422, "not-located")
    assert narrow.client.get("/readyz").status_code == 200


def test_a_snapshot_that_takes_too_long_is_ended(tmp_path_factory: pytest.TempPathFactory) -> None:
    settings = Settings(data_dir=tmp_path_factory.mktemp("hasty"), locate_workers=1, build_workers=1)
    with serve(replace(settings, locate_timeout_s=0.02), worker=False) as hasty:
        site_id = site_with_map(hasty)
        assert_problem(locate_alone(hasty, site_id), 504, "timed-out")
        assert hasty.client.get("/healthz").status_code == 200
        with hasty.services.database.reading() as session:
            assert session.query(SnapshotRow).count() == 0  # nothing was seen, so nothing is recorded
