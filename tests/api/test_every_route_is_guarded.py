"""Each route of the OpenAPI document refuses whoever has no key, a key of another scope, a key of another site."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import httpx
import pytest

from app.api.security import NAMES_SITE
from app.services.live_evaluation import open_live
from app.services.principal import SCOPES
from app.storage.alerts import AlertFilter, AlertRepository
from app.storage.live_records import LiveOptions
from app.storage.models import SnapshotRow
from app.storage.paging import PageRequest
from app.storage.sites import SiteRepository
from app.storage.target_maps import TargetMapRepository
from app.storage.trajectories import TrajectoryRepository
from app.trajectories.robotics_formats import tum_text
from tests.api.guarding import Guarded
from tests.api.serving import assert_problem, room_photos
from tests.api.test_trajectory_import import imported
from tests.storage import examples
from tests.trajectories.walks import walk

FOR_EVERYBODY = {"/healthz", "/readyz", "/time", "/session"}
# What every key may read, of its sites: no scope is the wrong one.
READ_BY_ALL = {
    "/sites",
    "/sites/{site_id}",
    "/sites/{site_id}/targets",
    "/sites/{site_id}/coverage",
    "/sites/{site_id}/maps",
    "/cameras",
}
PRINTED = {
    "/targets/sheets.pdf",
    "/targets/{code}.svg",
    "/targets/{code}.png",
}  # of no site, unless the query names one
FILTERED = {"/sites", "/cameras", "/trajectories", "/jobs", "/evaluations", "/evaluations/live"}
# Where a site, or a trajectory of one, stands in the body.
NAMED_IN_BODY: dict[tuple[str, str], tuple[str, tuple[str, ...]]] = {
    ("post", "/trajectories"): ("json", ("site_id",)),
    ("post", "/trajectories/import"): ("data", ("site_id",)),
    ("post", "/evaluations"): ("json", ("reference_id", "estimate_id")),
    ("post", "/evaluations/live"): ("json", ("reference_id",)),
    ("post", "/locate"): ("data", ("site_id",)),
    ("post", "/cameras/calibrations"): ("data", ("site_id",)),
}
# Calls that take a file beside the fields of their form.
FILES = {"/locate": "image", "/trajectories/import": "file", "/cameras/calibrations": "images"}


@dataclass(frozen=True)
class Call:
    """A call of the document."""

    method: str
    path: str
    scopes: frozenset[str]

    @property
    def key(self) -> tuple[str, str]:
        return self.method, self.path

    @property
    def names_site(self) -> bool:
        return any(f"{{{name}}}" in self.path for name in NAMES_SITE)


@dataclass(frozen=True)
class Furnished:
    """A site with one of everything, and another one without anything."""

    ids: dict[str, Any]
    other_site_id: str

    def send(self, client: httpx.Client, call: Call, **content: Any) -> httpx.Response:
        return client.request(call.method, call.path.format(**self.ids), **content)


def calls_of(guarded: Guarded) -> list[Call]:
    document = guarded.client.get("/openapi.json").json()
    found = []
    for path, methods in document["paths"].items():
        for method, described in methods.items():
            scopes = {scope for entry in described.get("security", []) for names in entry.values() for scope in names}
            found.append(Call(method, path, frozenset(scopes)))
    return found


@pytest.fixture(scope="module")
def calls(guarded: Guarded) -> list[Call]:
    found = [call for call in calls_of(guarded) if call.path not in FOR_EVERYBODY]
    assert len(found) > 30
    return found


@pytest.fixture(scope="module")
def furnished(guarded: Guarded) -> Furnished:
    site_id, other_site_id = guarded.new_site(), guarded.new_site()
    survey_id = guarded.new_survey(site_id)
    for name, data in list(room_photos("survey").items())[:2]:
        assert guarded.put_photo(survey_id, name, data).status_code == 201
    job = guarded.client.post(f"/surveys/{survey_id}/build", json={})
    assert job.status_code == 202, job.text
    with guarded.services.database.writing() as session:
        maps = TargetMapRepository(session)
        maps.activate(site_id, maps.publish(site_id, examples.publication(site_id, survey_id)))
        trajectory = TrajectoryRepository(session).default(site_id, "phone")
        snapshot = examples.snapshot(SiteRepository(session).get(site_id), examples.located())
        pose = TrajectoryRepository(session).record(trajectory.trajectory_id, snapshot)
        alerts = AlertRepository(session)
        alerts.settle(site_id, 1, [examples.trouble()], now_s=1.0)
        (alert,) = alerts.page(AlertFilter(site_id), PageRequest()).items
        live = open_live(session, trajectory.trajectory_id, "uwb", LiveOptions())
    estimate_id = imported(guarded, "".join(tum_text([walk(5.0)])), site_id=site_id)["trajectory_id"]
    truth_id = imported(guarded, "".join(tum_text([walk(5.0)])), site_id=site_id)["trajectory_id"]
    camera = guarded.client.get("/cameras", params={"site_id": site_id}).json()["cameras"][0]
    evaluation = guarded.client.post("/evaluations", json={"reference_id": truth_id, "estimate_id": estimate_id})
    ids = {
        "evaluation_id": evaluation.json()["evaluation_id"],
        "live_id": live.live_id,
        "alert_id": alert.alert_id,
        "camera_id": camera["camera_id"],
        "reference_id": truth_id,
        "estimate_id": estimate_id,
        "site_id": site_id,
        "survey_id": survey_id,
        "job_id": job.json()["job_id"],
        "trajectory_id": trajectory.trajectory_id,
        "pose_id": pose.pose_id,
        "key_id": guarded.new_key("locate")["key_id"],
        "version": 1,
        "filename": "new.jpg",
        "code": 389,
    }
    return Furnished(ids, other_site_id)


@pytest.fixture(scope="module")
def anonymous(guarded: Guarded) -> Iterator[httpx.Client]:
    with guarded.anonymous() as client:
        yield client


@pytest.fixture(scope="module")
def elsewhere(guarded: Guarded, furnished: Furnished) -> Iterator[httpx.Client]:
    """May do everything, on the other site."""
    with guarded.holder("admin", site_ids=[furnished.other_site_id]) as client:
        yield client


def test_every_route_says_its_scopes(calls: list[Call]) -> None:
    assert [call for call in calls if not call.scopes] == []


def test_nothing_opens_without_a_key(calls: list[Call], furnished: Furnished, anonymous: httpx.Client) -> None:
    for call in calls:
        refused = furnished.send(anonymous, call)
        assert_problem(refused, 401, "not-authenticated")
        assert refused.headers["WWW-Authenticate"].startswith("Bearer")


def test_a_wrong_key_is_refused_alike(calls: list[Call], furnished: Furnished, guarded: Guarded) -> None:
    with guarded.with_secret("smk_" + "x" * 43) as client:
        for call in calls:
            assert_problem(furnished.send(client, call), 401, "not-authenticated")


def test_a_key_of_another_scope_is_refused(calls: list[Call], furnished: Furnished, guarded: Guarded) -> None:
    keys = {scope: guarded.new_key(scope)["secret"] for scope in SCOPES}
    open_to_all = set()
    for call in calls:
        wrong = [scope for scope in SCOPES if scope not in call.scopes and scope != "admin"]
        if not wrong:
            open_to_all.add(call.path)
        for scope in wrong:
            headers = {"Authorization": f"Bearer {keys[scope]}"}
            refused = furnished.send(guarded.client, call, headers=headers)
            assert assert_problem(refused, 403, "not-allowed")["needs"], call
    assert open_to_all == READ_BY_ALL | PRINTED


def test_a_key_of_another_site_learns_nothing(calls: list[Call], furnished: Furnished, elsewhere: httpx.Client) -> None:
    for call in calls:
        answer = send_naming_site(elsewhere, call, furnished)
        if call.names_site or call.key in NAMED_IN_BODY:
            assert_problem(answer, 404, "not-found")
        elif call.path in PRINTED:
            assert answer.status_code in (200, 422), call
        elif call.path in FILTERED and call.method == "get":
            assert answer.status_code == 200, call
            assert not [value for value in furnished.ids.values() if str(value) in answer.text and value != 1], call
        else:
            assert_problem(answer, 403, "not-allowed")


def send_naming_site(client: httpx.Client, call: Call, furnished: Furnished) -> httpx.Response:
    """The call, with the furnished site where a body names one."""
    if call.key not in NAMED_IN_BODY:
        return furnished.send(client, call)
    place, names = NAMED_IN_BODY[call.key]
    content: dict[str, Any] = {place: {name: furnished.ids[name] for name in names}}
    if call.path in FILES:
        content["files"] = {FILES[call.path]: b"never looked at"}
    return furnished.send(client, call, **content)


def test_what_is_elsewhere_is_as_what_is_nowhere(furnished: Furnished, elsewhere: httpx.Client) -> None:
    """Not even the words differ."""
    for kind in ("survey", "job", "trajectory", "site"):
        real, unreal = furnished.ids[f"{kind}_id"], "01a20000-0000-7000-8000-000000000000"
        path = {"trajectory": "trajectories"}.get(kind, f"{kind}s")
        methods = ("POST", f"/{path}/{{}}/close") if kind == "trajectory" else ("GET", f"/{path}/{{}}")
        texts = []
        for identifier in (real, unreal):
            problem = assert_problem(elsewhere.request(methods[0], methods[1].format(identifier)), 404, "not-found")
            texts.append(problem["detail"].replace(identifier, "..."))
        assert texts[0] == texts[1]


def test_queries_name_no_other_site_either(furnished: Furnished, elsewhere: httpx.Client) -> None:
    for path in ("/trajectories", "/cameras", "/jobs", "/targets/sheets.pdf?count=1"):
        assert_problem(elsewhere.get(path, params={"site_id": furnished.ids["site_id"]}), 404, "not-found")
    raw = elsewhere.post("/locate", params={"site_id": furnished.ids["site_id"]}, content=b"never looked at")
    assert_problem(raw, 404, "not-found")


def test_a_key_works_on_its_own_site(furnished: Furnished, guarded: Guarded) -> None:
    site_id, survey_id = furnished.ids["site_id"], furnished.ids["survey_id"]
    with guarded.holder("survey", "locate", site_ids=[site_id]) as client:
        assert [site["site_id"] for site in client.get("/sites").json()["sites"]] == [site_id]
        for path in (f"/sites/{site_id}", f"/surveys/{survey_id}", f"/surveys/{survey_id}/images"):
            assert client.get(path).status_code == 200
        for path in ("jobs", "sites"):
            assert client.get(f"/{path}/{furnished.ids[path[:-1] + '_id']}").status_code == 200
        assert client.get("/cameras").json()["cameras"]
        assert client.post("/trajectories", json={"site_id": site_id}).status_code == 201
        assert client.post(f"/sites/{site_id}/surveys").status_code == 201
        assert_problem(client.post("/sites", json={"name": "mine"}), 403, "not-allowed")


def test_a_snapshot_of_a_locate_key_is_located_or_refused_for_what_it_shows(
    furnished: Furnished, guarded: Guarded, snapshot: bytes
) -> None:
    """The key opens, so that what answers is the measurement."""
    site_id = furnished.ids["site_id"]
    with guarded.holder("locate", site_ids=[site_id]) as client:
        answer = client.post("/locate", data={"site_id": site_id}, files={"image": snapshot})
    assert_problem(answer, 422, "not-located")
    with guarded.services.database.reading() as session:
        assert session.query(SnapshotRow).filter_by(site_id=site_id, device_id=None).count() == 1


def test_documents_and_health_are_for_everybody(anonymous: httpx.Client) -> None:
    for path in ("/healthz", "/readyz", "/time", "/openapi.json", "/docs"):
        assert anonymous.get(path).status_code in (200, 503), path


def test_the_document_names_schemes_scopes_and_refusals(guarded: Guarded) -> None:
    document = guarded.client.get("/openapi.json").json()
    schemes = document["components"]["securitySchemes"]
    assert schemes["key"]["scheme"] == "bearer"
    assert schemes["session"]["in"] == "cookie"
    assert document["paths"]["/locate"]["post"]["security"] == [{"key": ["locate"]}, {"session": ["locate"]}]
    for methods in document["paths"].values():
        for call in methods.values():
            if "security" in call:
                assert {"401", "403", "429"} <= set(call["responses"])
