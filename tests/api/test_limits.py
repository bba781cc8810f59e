"""A full server and a slow snapshot: one request pays, with a problem that says when to come back."""

from __future__ import annotations

import io
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest
from PIL import Image

from app.settings import Settings
from app.storage.models import SnapshotRow
from app.storage.target_maps import TargetMapRepository
from tests.api.serving import Served, assert_problem, hurried, serve
from tests.storage.examples import publication

CROWD = 6
LARGE_PX = (6000, 4000)  # tenths of a second of decoding
HASTY_S = 0.02
ANSWER_S = 120.0  # a test waits no longer; none needs that


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
    with serve(Settings(data_dir=folder, locate_workers=1, build_workers=1, queue_depth=0), worker=False) as running:
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


def test_a_snapshot_that_takes_too_long_is_ended(narrow: Served) -> None:
    site_id = site_with_map(narrow)
    with hurried(narrow, HASTY_S):
        assert_problem(locate_alone(narrow, site_id), 504, "timed-out")
    assert narrow.client.get("/healthz").status_code == 200
    with narrow.services.database.reading() as session:
        assert session.query(SnapshotRow).filter_by(site_id=site_id).count() == 0  # nothing was seen or recorded
