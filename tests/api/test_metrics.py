"""What is counted, asked for as Prometheus does it."""

from __future__ import annotations

import io
import re

import pytest
from PIL import Image

from tests.api.conftest import SurveyedRoom
from tests.api.metrics_reading import scrape
from tests.api.serving import Served, assert_problem

# https://prometheus.io/docs/practices/naming/: base units, plural, in the name.
NAME = re.compile(r"scattermark_[a-z_]+")
FOREIGN = ("process_", "python_")
LABELS = {"method", "route", "status", "stage", "reason", "pool", "task", "access", "state", "kind", "version", "le"}
STAGES = ("decode", "detect", "resect", "record")


@pytest.fixture(scope="module")
def blank() -> bytes:
    """A photograph without targets."""
    buffer = io.BytesIO()
    Image.new("RGB", (640, 480), (128, 128, 128)).save(buffer, "JPEG")
    return buffer.getvalue()


def test_a_request_is_counted_by_its_route(served: Served) -> None:
    labels = {"method": "GET", "route": "/sites/{site_id}"}
    before = scrape(served)
    for site_id in ("one", "another"):
        assert served.client.get(f"/sites/{site_id}").status_code == 404
    after = scrape(served)
    counted = "scattermark_http_requests_total"
    assert after.value(counted, **labels, status="404") - before.value(counted, **labels, status="404") == 2
    timed = "scattermark_http_request_duration_seconds_count"
    assert after.value(timed, **labels) - before.value(timed, **labels) == 2


def test_whatever_is_asked_for_the_labels_stay_few(served: Served) -> None:
    for number in range(5):
        served.client.get(f"/nowhere/{number}")
        served.client.request(f"METHOD{number}", "/sites")
    routes = set(served.client.get("/openapi.json").json()["paths"]) | {"other", "/docs"}
    for family in scrape(served).families.values():
        for sample in family.samples:
            if not sample.name.startswith(FOREIGN):
                assert set(sample.labels) <= LABELS, sample
                assert sample.labels.get("route", "other") in routes
                assert not sample.labels.get("method", "").startswith("METHOD")


def test_names_say_whose_they_are(served: Served) -> None:
    for name, family in scrape(served).families.items():
        assert name.startswith(FOREIGN) or NAME.fullmatch(name)
        assert family.documentation


def test_a_snapshot_is_counted_with_the_time_of_its_stages(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    before = scrape(served)
    assert served.locate(room.site_id, snapshot).status_code == 200
    after = scrape(served)
    located = "scattermark_locate_located_total"
    assert after.value(located) - before.value(located) == 1
    for stage in STAGES:
        counted = "scattermark_locate_stage_duration_seconds_count"
        assert after.value(counted, stage=stage) > before.value(counted, stage=stage), stage
        assert after.value("scattermark_locate_stage_duration_seconds_sum", stage=stage) > 0.0
    for counted in ("scattermark_pool_task_wait_seconds_count", "scattermark_pool_task_duration_seconds_count"):
        labels = {"pool": "locate", "task": "locate_photo"}
        assert after.value(counted, **labels) > before.value(counted, **labels)


def test_refusals_are_counted_by_reason(served: Served, room: SurveyedRoom, blank: bytes) -> None:
    refused = "scattermark_locate_refusals_total"
    before = scrape(served)
    assert_problem(served.locate(room.site_id, blank), 422, "not-located")
    assert_problem(served.locate(room.site_id, b"no photograph"), 415, "bad-photo")
    assert_problem(served.locate("nowhere", blank), 404, "not-found")
    after = scrape(served)
    for reason in ("no-targets", "bad-photo", "not-found"):
        assert after.value(refused, reason=reason) - before.value(refused, reason=reason) == 1, reason


def test_pools_connections_jobs_and_photographs_are_shown(served: Served, room: SurveyedRoom) -> None:
    shown = scrape(served)
    assert room.job["state"] == "succeeded"
    assert shown.value("scattermark_pool_workers", pool="locate") == served.settings.locate_workers
    assert shown.value("scattermark_pool_worker_starts_total", pool="locate") >= served.settings.locate_workers
    connections = shown.families["scattermark_database_connections"].samples
    assert {sample.labels["access"] for sample in connections} >= {"read", "write", "record"}
    assert shown.value("scattermark_database_up") == 1
    assert shown.value("scattermark_jobs", kind="build", state="succeeded") >= 1
    assert shown.value("scattermark_jobs_oldest_queued_age_seconds") == 0
    stored = served.client.get(f"/surveys/{room.survey_id}/images").json()["images"]
    assert shown.value("scattermark_photographs") >= len(stored) > 0
    assert shown.value("scattermark_disk_free_bytes") > 0
    assert shown.value("scattermark_stored_bytes") >= sum(image["bytes"] for image in stored)
