"""Each route that changes something leaves one row in the audit, in the transaction of the change."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import httpx
import pytest

from app.storage.alerts import AlertFilter, AlertRepository
from app.storage.paging import PageRequest
from app.storage.sites import SiteRepository
from app.storage.target_maps import TargetMapRepository
from app.storage.trajectories import TrajectoryRepository
from app.trajectories.robotics_formats import tum_text
from tests.api.guarding import ADMIN_SECRET, Guarded
from tests.api.serving import assert_problem, room_photos
from tests.api.test_every_route_is_guarded import calls_of
from tests.storage import examples
from tests.trajectories.walks import walk

SAFE = ("get", "head", "options")
# Snapshots are recorded in their trajectory, samples in their live evaluation.
NOT_AUDITED = {("post", "/locate"), ("post", "/evaluations/live/{live_id}/samples")}


def entries(guarded: Guarded, **query: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = guarded.client.get("/audit", params={"limit": 1000, **query}).json()["entries"]
    return found


def raise_alert(guarded: Guarded, site_id: str) -> str:
    with guarded.services.database.writing() as session:
        alerts = AlertRepository(session)
        alerts.settle(site_id, 1, [examples.trouble()], now_s=1.0)
        return alerts.page(AlertFilter(site_id), PageRequest()).items[0].alert_id


def changes(guarded: Guarded) -> dict[tuple[str, str], Callable[[], httpx.Response]]:
    """A call of each route that changes something, in an order in which each can succeed."""
    client, photos = guarded.client, list(room_photos("survey").items())
    ids: dict[str, str] = {}

    def keep(name: str, answer: httpx.Response) -> httpx.Response:
        ids[name] = answer.json().get(name, "")
        return answer

    def with_session(method: str) -> httpx.Response:
        with guarded.anonymous() as browser:
            opened = browser.post("/session", json={"key": ADMIN_SECRET})
            return opened if method == "POST" else browser.delete("/session")

    def imported() -> httpx.Response:
        site_id = guarded.new_site()
        archive = client.get(f"/sites/{site_id}/export").content
        assert client.delete(f"/sites/{site_id}").is_success
        return client.post("/sites/import", content=archive)

    def removed() -> httpx.Response:
        cancel_jobs(guarded, ids["job_id"], ids["calibration_id"])
        return client.delete(f"/sites/{ids['site_id']}")

    def activated() -> httpx.Response:
        with guarded.services.database.writing() as session:
            TargetMapRepository(session).publish(ids["site_id"], examples.publication(ids["job_id"], ids["survey_id"]))
        return client.post(f"/sites/{ids['site_id']}/maps/1/activate")

    def posed() -> str:
        with guarded.services.database.writing() as session:
            site = SiteRepository(session).get(ids["site_id"])
            snapshot = examples.snapshot(site, examples.located())
            return TrajectoryRepository(session).record(ids["trajectory_id"], snapshot).pose_id

    def walked() -> httpx.Response:
        text = "".join(tum_text([walk(5.0)]))
        return client.post("/trajectories/import", params={"site_id": ids["site_id"]}, content=text)

    def evaluated() -> httpx.Response:
        both = [walked().json()["trajectory_id"] for _ in range(2)]
        return client.post("/evaluations", json={"reference_id": both[0], "estimate_id": both[1]})

    def opened_live() -> httpx.Response:
        return client.post("/evaluations/live", json={"reference_id": ids["trajectory_id"]})

    return {
        ("post", "/sites"): lambda: keep("site_id", client.post("/sites", json={"name": "hall"})),
        ("patch", "/sites/{site_id}"): lambda: client.patch(f"/sites/{ids['site_id']}", json={"name": "aisle"}),
        ("put", "/sites/{site_id}/control-points"): lambda: client.put(
            f"/sites/{ids['site_id']}/control-points", json=[]
        ),
        ("put", "/sites/{site_id}/print-batches"): lambda: client.put(
            f"/sites/{ids['site_id']}/print-batches", json={"print_batches": []}
        ),
        ("post", "/sites/{site_id}/surveys"): lambda: keep(
            "survey_id", client.post(f"/sites/{ids['site_id']}/surveys")
        ),
        ("put", "/surveys/{survey_id}/images/{filename}"): lambda: client.put(
            f"/surveys/{ids['survey_id']}/images/a.jpg", content=photos[0][1]
        ),
        ("post", "/surveys/{survey_id}/images"): lambda: client.post(
            f"/surveys/{ids['survey_id']}/images", files=[("images", photo) for photo in photos[1:3]]
        ),
        ("put", "/surveys/{survey_id}/images/{filename}/marks"): lambda: client.put(
            f"/surveys/{ids['survey_id']}/images/a.jpg/marks", json={"marks": []}
        ),
        ("delete", "/surveys/{survey_id}/images/{filename}/marks"): lambda: client.delete(
            f"/surveys/{ids['survey_id']}/images/a.jpg/marks"
        ),
        ("post", "/surveys/{survey_id}/build"): lambda: keep(
            "job_id", client.post(f"/surveys/{ids['survey_id']}/build")
        ),
        ("post", "/jobs/{job_id}/cancel"): lambda: client.post(f"/jobs/{ids['job_id']}/cancel"),
        ("post", "/jobs/{job_id}/retry"): lambda: client.post(f"/jobs/{ids['job_id']}/retry"),
        ("post", "/sites/{site_id}/maps/{version}/activate"): activated,
        ("post", "/cameras/calibrations"): lambda: calibrated(guarded, ids),
        ("delete", "/cameras/{camera_id}"): lambda: camera_forgotten(guarded, ids["site_id"]),
        ("post", "/alerts/{alert_id}/acknowledge"): lambda: client.post(
            f"/alerts/{raise_alert(guarded, ids['site_id'])}/acknowledge"
        ),
        ("post", "/trajectories"): lambda: keep(
            "trajectory_id", client.post("/trajectories", json={"site_id": ids["site_id"]})
        ),
        ("delete", "/poses/{pose_id}"): lambda: client.delete(f"/poses/{posed()}"),
        ("post", "/trajectories/{trajectory_id}/close"): lambda: client.post(
            f"/trajectories/{ids['trajectory_id']}/close"
        ),
        ("post", "/trajectories/import"): walked,
        ("post", "/evaluations"): lambda: keep("evaluation_id", evaluated()),
        ("delete", "/evaluations/{evaluation_id}"): lambda: client.delete(f"/evaluations/{ids['evaluation_id']}"),
        ("post", "/evaluations/live"): lambda: keep("live_id", opened_live()),
        ("post", "/evaluations/live/{live_id}/trajectory"): lambda: kept_samples(guarded, ids["live_id"]),
        ("post", "/evaluations/live/{live_id}/close"): lambda: client.post(f"/evaluations/live/{ids['live_id']}/close"),
        ("delete", "/evaluations/live/{live_id}"): lambda: client.delete(f"/evaluations/live/{ids['live_id']}"),
        ("delete", "/sites/{site_id}/snapshots"): lambda: client.delete(
            f"/sites/{ids['site_id']}/snapshots", params={"device_id": "phone-1"}
        ),
        ("delete", "/trajectories/{trajectory_id}"): lambda: client.delete(f"/trajectories/{ids['trajectory_id']}"),
        ("post", "/keys"): lambda: keep("key_id", client.post("/keys", json={"name": "phone", "scopes": ["locate"]})),
        ("delete", "/keys/{key_id}"): lambda: client.delete(f"/keys/{ids['key_id']}"),
        ("post", "/session"): lambda: with_session("POST"),
        ("delete", "/session"): lambda: with_session("DELETE"),
        ("post", "/sites/import"): imported,
        ("delete", "/sites/{site_id}"): removed,
    }


def cancel_jobs(guarded: Guarded, *job_ids: str) -> None:
    """A site is not removed under a build."""
    for job_id in job_ids:
        assert guarded.client.post(f"/jobs/{job_id}/cancel").is_success


def calibrated(guarded: Guarded, ids: dict[str, str]) -> httpx.Response:
    images = [("images", photo) for photo in list(room_photos("survey").items())[:5]]
    answer = guarded.client.post("/cameras/calibrations", data={"site_id": ids["site_id"]}, files=images)
    ids["calibration_id"] = answer.json().get("job_id", "")
    return answer


def camera_forgotten(guarded: Guarded, site_id: str) -> httpx.Response:
    (camera,) = guarded.client.get("/cameras", params={"site_id": site_id}).json()["cameras"]
    return guarded.client.delete(f"/cameras/{camera['camera_id']}")


def kept_samples(guarded: Guarded, live_id: str) -> httpx.Response:
    path = f"/evaluations/live/{live_id}"
    sent = guarded.client.post(f"{path}/samples", json={"samples": [{"time_s": 1.0, "x_m": 0.0, "y_m": 0.0}]})
    assert sent.is_success, sent.text
    return guarded.client.post(f"{path}/trajectory")


def test_each_change_leaves_one_row(guarded: Guarded) -> None:
    done = changes(guarded)
    documented = {call.key for call in calls_of(guarded) if call.method not in SAFE} - NOT_AUDITED
    assert documented == set(done), "a route that changes something is missing here"
    for (method, path), change in done.items():
        action = f"{method.upper()} {path}"
        before = {entry["entry_id"] for entry in entries(guarded)}
        answer = change()
        assert answer.is_success, (action, answer.text)
        new = [entry for entry in entries(guarded) if entry["entry_id"] not in before]
        (entry,) = [entry for entry in new if entry["action"].replace(":path}", "}") == action] or pytest.fail(
            f"{action}: {new}"
        )
        assert entry["outcome"] == "done"
        assert (entry["name"], entry["address"]) == ("bootstrap", "127.0.0.1")
        assert entry["request_id"] == answer.headers["x-request-id"]
        assert path.startswith(("/keys", "/session")) or entry["subject"].get("site_id"), entry


def test_an_entry_names_what_was_made(guarded: Guarded) -> None:
    site_id = guarded.new_site()
    survey_id = guarded.new_survey(site_id)
    opened, made = entries(guarded, site_id=site_id)
    assert made["action"] == "POST /sites"
    assert made["subject"] == {"site_id": site_id}
    assert opened["subject"] == {"site_id": site_id, "survey_id": survey_id}


def test_entries_of_one_key(guarded: Guarded) -> None:
    issued = guarded.new_key("survey")
    with guarded.with_secret(issued["secret"]) as client:
        assert client.post("/sites", json={"name": "hall"}).status_code == 201
        assert client.get("/sites").status_code == 200
    (entry,) = entries(guarded, key_id=issued["key_id"])
    assert entry["name"] == "test"


def test_what_fails_leaves_no_row(guarded: Guarded) -> None:
    before = entries(guarded)
    assert_problem(guarded.client.patch("/sites/nowhere", json={"name": "x"}), 404, "not-found")
    assert_problem(guarded.client.post("/sites", json={"name": ""}), 422, "invalid-input")
    with guarded.anonymous() as nobody:
        assert nobody.post("/sites", json={"name": "hall"}).status_code == 401
        assert nobody.post("/session", json={"key": "smk_guessed"}).status_code == 401
        assert nobody.delete("/session").status_code == 204
    assert entries(guarded) == before


@pytest.mark.parametrize("bound", [False, True])
def test_a_refusal_of_a_valid_key_is_kept(guarded: Guarded, bound: bool) -> None:
    site_id, other_site_id = guarded.new_site(), guarded.new_site()
    body: dict[str, Any] = {"site_ids": [other_site_id]} if bound else {}
    issued = guarded.new_key("survey" if bound else "locate", **body)
    with guarded.with_secret(issued["secret"]) as client:
        assert client.delete(f"/sites/{site_id}").status_code == (404 if bound else 403)
        assert client.get(f"/sites/{site_id}/surveys").status_code == (404 if bound else 403)
    (entry,) = entries(guarded, key_id=issued["key_id"])
    assert entry["outcome"] == "refused"
    assert entry["action"] == "DELETE /sites/{site_id}"
    assert entry["subject"] == {"site_id": site_id}


def test_pages_go_back_in_time(guarded: Guarded) -> None:
    guarded.new_site()
    first = guarded.client.get("/audit", params={"limit": 1}).json()
    second = guarded.client.get("/audit", params={"limit": 1, "cursor": first["next_cursor"]}).json()
    assert first["entries"][0]["entry_id"] > second["entries"][0]["entry_id"]
