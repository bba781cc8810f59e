"""A running system compared while its reference is being located: samples in, the error so far out."""

from __future__ import annotations

import threading
import time
from typing import Any

import httpx
import numpy as np
import pytest

from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem
from tests.api.test_trajectories import events, opened
from tests.storage.walks import START_S, Step, add_steps

OFF_M = 0.3  # of the system, along x


def step(after_s: float) -> Step:
    return Step(after_s, (after_s, 2.0, 1.5))


def sample(after_s: float, **more: Any) -> dict[str, Any]:
    return {"time_s": START_S + after_s, "x_m": after_s + OFF_M, "y_m": 2.0, "z_m": 1.5, **more}


class Live:
    """A live evaluation on a trajectory of its own."""

    def __init__(self, served: Served, **options: Any) -> None:
        self._served = served
        self.site_id = served.new_site()
        self.reference_id = str(opened(served, self.site_id)["trajectory_id"])
        body = {"reference_id": self.reference_id, "name": "wifi", "options": options}
        answer = served.client.post("/evaluations/live", json=body)
        assert answer.status_code == 201, answer.text
        self.path = f"/evaluations/live/{answer.json()['live_id']}"

    def walk(self, *after_s: float) -> None:
        """The reference goes on, as if another server located it."""
        steps = [step(second) for second in after_s]
        add_steps(self._served.services.database, self.reference_id, self.site_id, steps)

    def send(self, *samples: dict[str, Any]) -> dict[str, Any]:
        answer = self._served.client.post(f"{self.path}/samples", json={"samples": samples})
        assert answer.status_code == 200, answer.text
        told: dict[str, Any] = answer.json()
        return told

    def state(self) -> dict[str, Any]:
        told: dict[str, Any] = self._served.client.get(self.path).json()
        return told

    def close(self) -> httpx.Response:
        return self._served.client.post(f"{self.path}/close")


def counts(told: dict[str, Any]) -> tuple[int, int, int]:
    return told["matched"], told["waiting"], told["missed"]


def test_a_sample_waits_for_the_pose_after_it(served: Served) -> None:
    live = Live(served)
    live.walk(0.0)
    assert counts(live.send(sample(0.5))) == (0, 1, 0)
    assert live.state()["error"]["rmse_m"] is None
    live.walk(1.0)
    state = live.state()
    assert counts(state) == (1, 0, 0)
    assert state["error"]["rmse_m"] == pytest.approx(OFF_M)
    assert state["error"]["CE95_m"] == pytest.approx(OFF_M)


def test_a_moment_counts_once(served: Served) -> None:
    live = Live(served)
    live.walk(0.0, 1.0)
    first = live.send(sample(0.25), sample(0.5), sample(0.25, x_m=9.0))
    assert (first["accepted"], first["duplicates"], first["matched"]) == (2, 1, 2)
    again = live.send(sample(0.25, x_m=9.0), sample(0.75))
    assert (again["accepted"], again["duplicates"], again["matched"]) == (1, 1, 3)
    assert live.state()["error"]["rmse_m"] == pytest.approx(OFF_M)


def test_what_the_reference_passed_by_is_missed(served: Served) -> None:
    live = Live(served, max_gap_s=1.0)
    live.walk(0.0, 5.0)
    assert counts(live.send(sample(2.5))) == (0, 1, 0)  # a snapshot of that moment may still be under way
    live.walk(60.0)
    assert counts(live.state()) == (0, 0, 1)


def test_events_tell_each_pair_and_resume(served: Served) -> None:
    live = Live(served)
    live.walk(0.0, 1.0, 2.0)
    live.send(sample(0.5), sample(1.5, x_m=1.5), sample(2.5))
    closed = live.close().json()
    assert counts(closed) == (2, 0, 1)
    assert live.close().json() == closed
    path = f"{live.path}/events"
    with served.client.stream("GET", path, params={"last_event_id": "0"}) as response:
        found = list(events(response))
    assert [(item["event"], item.get("id")) for item in found] == [("error", "1"), ("error", "2"), ("closed", None)]
    first, second, last = (item["data"] for item in found)
    assert first["last"]["error_m"] == pytest.approx([OFF_M, 0.0, 0.0])
    assert second["last"]["distance_m"] == pytest.approx(0.0)
    assert second["rmse_m"] == pytest.approx(OFF_M / 2**0.5)
    assert second["mean_m"] == pytest.approx(OFF_M / 2)
    assert first["last"]["reference_sigma_m"] == pytest.approx(0.001)
    assert (last["matched"], last["missed"], last["rmse_m"]) == (2, 1, second["rmse_m"])
    with served.client.stream("GET", path, headers={"Last-Event-ID": "1"}) as response:
        assert [item["data"] for item in events(response)] == [second, last]
    assert_problem(served.client.get(path, headers={"Last-Event-ID": "3"}), 422, "invalid-input")
    refused = served.client.post(f"{live.path}/samples", json={"samples": [sample(3.0)]})
    assert_problem(refused, 409, "conflict")


def test_the_error_appears_while_the_phone_is_located(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    reference_id = opened(served, room.site_id)["trajectory_id"]
    body = {"reference_id": reference_id, "options": {"max_gap_s": 2.0}}
    path = f"/evaluations/live/{served.client.post('/evaluations/live', json=body).json()['live_id']}"
    poses: list[dict[str, Any]] = []

    def walk() -> None:
        for captured_s in (START_S, START_S + 1.0):
            query = {"trajectory_id": reference_id, "captured_at": str(captured_s)}
            poses.append(served.locate(room.site_id, snapshot, **query).json())
            where = dict(zip(("x_m", "y_m", "z_m"), poses[0]["position_m"], strict=True))
            position = {**where, "time_s": captured_s + 0.5, "x_m": where["x_m"] + OFF_M}
            served.client.post(f"{path}/samples", json={"samples": [position]})
        served.client.post(f"{path}/close")

    walker = threading.Thread(target=walk)
    with served.client.stream("GET", f"{path}/events") as response:
        walker.start()
        found = list(events(response))
    walker.join()
    assert [item["event"] for item in found] == ["error", "closed"]
    assert found[0]["data"]["last"]["error_m"] == pytest.approx([OFF_M, 0.0, 0.0], abs=1e-9)
    assert found[1]["data"]["missed"] == 1  # nothing came after the last


def test_orientations_storeys_and_plans(served: Served) -> None:
    live = Live(served, floor_height_m=3.0)
    live.walk(0.0, 1.0)
    turned = served.client.get(f"/trajectories/{live.reference_id}").json()["poses"][0]["orientation_xyzw"]
    plan = {name: value for name, value in sample(1.0).items() if name != "z_m"}
    live.send(sample(0.0, orientation=turned, floor=1), plan)
    live.close()
    with served.client.stream("GET", f"{live.path}/events", params={"last_event_id": "0"}) as response:
        first, second = (item["data"]["last"] for item in list(events(response))[:2])
    assert first["angle_rad"] == pytest.approx(0.0, abs=1e-7)
    assert first["right_floor"] is False
    assert second["error_m"][2] is None
    assert second["right_floor"] is None
    assert second["distance_m"] == pytest.approx(OFF_M)


def test_it_goes_with_its_samples_and_its_reference(served: Served) -> None:
    live = Live(served)
    live.send(sample(0.0))
    assert served.client.delete(live.path).status_code == 204
    assert_problem(served.client.get(live.path), 404, "not-found")
    other = Live(served)
    assert served.client.delete(f"/trajectories/{other.reference_id}").status_code == 204
    assert_problem(served.client.get(other.path), 404, "not-found")


@pytest.mark.parametrize(
    "wrong",
    [
        {"samples": []},
        {"samples": [{"time_s": START_S, "x_m": 1.0}]},
        {"samples": [{**sample(0.0), "time_s": -1.0}]},
        {"samples": [{**sample(0.0), "orientation": [0, 0, 0, 0]}]},
        {"samples": [{**sample(0.0), "speed": 1.0}]},
    ],
)
def test_wrong_samples_are_told(served: Served, wrong: dict[str, Any]) -> None:
    live = Live(served)
    assert_problem(served.client.post(f"{live.path}/samples", json=wrong), 422, "invalid-input")
    assert live.state()["count"] == 0


def test_a_reference_that_is_not_there(served: Served) -> None:
    assert_problem(served.client.post("/evaluations/live", json={"reference_id": "nowhere"}), 404, "not-found")


# A system in a frame of its own

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
COURSE_M = [(0.5 * number, float((number % 4) ** 2) / 3.0, 1.5) for number in range(12)]


def elsewhere(place_m: tuple[float, float, float]) -> dict[str, float]:
    """Where a system with axes of its own has a place."""
    x_m, y_m, z_m = (TURN @ place_m + [100.0, -50.0, 7.0]).tolist()
    return {"x_m": x_m, "y_m": y_m, "z_m": z_m}


def walk_and_send(served: Served, live: Live) -> None:
    steps = [Step(float(number), place_m) for number, place_m in enumerate(COURSE_M)]
    add_steps(served.services.database, live.reference_id, live.site_id, steps)
    for number, place_m in enumerate(COURSE_M):
        live.send({"time_s": START_S + number, **elsewhere(place_m)})


@pytest.mark.parametrize("alignment", ["posyaw", "se3", "sim3", "first_n"])
def test_a_system_in_a_frame_of_its_own_is_aligned_as_pairs_come(served: Served, alignment: str) -> None:
    live = Live(served, alignment=alignment, first_n=8)
    walk_and_send(served, live)
    error = live.state()["error"]
    assert error["rmse_m"] == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(error["alignment"]["rotation"], TURN.T, atol=1e-9)
    assert error["alignment"]["pairs_used"] == (8 if alignment == "first_n" else 12)
    assert error["alignment"]["scale"] == pytest.approx(1.0)
    live.close()
    path = f"{live.path}/events"
    with served.client.stream("GET", path, params={"last_event_id": "0"}) as response:
        found = [item["data"] for item in events(response)]
    assert found[0]["rmse_m"] is None and found[0]["alignment"] is None  # one pair fixes no frame
    np.testing.assert_allclose(found[-2]["last"]["error_m"], 0.0, atol=1e-9)
    assert found[-2]["last"]["angle_rad"] is None
    with served.client.stream("GET", path, params={"last_event_id": "9"}) as response:
        assert [item["data"] for item in events(response)] == found[9:]


def test_a_plan_is_aligned_in_the_plan(served: Served) -> None:
    live = Live(served, alignment="posyaw")
    steps = [Step(float(number), place_m) for number, place_m in enumerate(COURSE_M)]
    add_steps(served.services.database, live.reference_id, live.site_id, steps)
    for number, place_m in enumerate(COURSE_M):
        told = elsewhere(place_m)
        live.send({"time_s": START_S + number, "x_m": told["x_m"], "y_m": told["y_m"]})
    assert live.state()["error"]["CE95_m"] == pytest.approx(0.0, abs=1e-9)


def test_latency_is_from_the_samples_moment_to_the_server(served: Served) -> None:
    live = Live(
        served, max_gap_s=5.0, time_offset_s=time.time() - START_S - 2.0
    )  # the sample's moment was two seconds ago
    steps = [Step(served_s - START_S, (0.0, 2.0, 1.5)) for served_s in (time.time() - 3.0, time.time() - 1.0)]
    add_steps(served.services.database, live.reference_id, live.site_id, steps)
    live.send(sample(0.0))
    latency_s = live.state()["error"]["latency_s"]
    assert 2.0 <= latency_s < 60.0


@pytest.mark.parametrize("option", [{"time_offset_s": "estimate"}, {"alignment": "origin"}])
def test_what_takes_a_whole_walk_is_refused_with_the_way_to_it(served: Served, option: dict[str, str]) -> None:
    reference_id = opened(served, served.new_site())["trajectory_id"]
    answer = served.client.post("/evaluations/live", json={"reference_id": reference_id, "options": option})
    assert "/evaluations/live/{live_id}/trajectory" in assert_problem(answer, 422, "invalid-input")["detail"]


def test_its_samples_are_evaluated_with_every_option_afterwards(served: Served) -> None:
    live = Live(served)
    assert_problem(served.client.post(f"{live.path}/trajectory"), 409, "conflict")
    walk_and_send(served, live)
    kept = served.client.post(f"{live.path}/trajectory", json={"name": "uwb, first walk"})
    assert kept.status_code == 201, kept.text
    assert (kept.json()["poses"], kept.json()["format"]) == (12, "live")
    body = {
        "reference_id": live.reference_id,
        "estimate_id": kept.json()["trajectory_id"],
        "options": {"alignment": "se3"},
    }
    answer = served.client.post("/evaluations", json=body)
    assert answer.status_code == 201, answer.text
    metrics = answer.json()["metrics"]
    assert metrics["accuracy"]["spatial_m"]["rms"] == pytest.approx(0.0, abs=1e-6)
    assert metrics["availability"]["latency_s"]["count"] == 12
    assert answer.json()["systems"][0]["name"] == "uwb, first walk"


def test_live_evaluations_are_listed_page_by_page(served: Served) -> None:
    live = Live(served)
    body = {"reference_id": live.reference_id, "name": "uwb"}
    second = served.client.post("/evaluations/live", json=body).json()
    query = {"site_id": live.site_id, "limit": 1}
    page = served.client.get("/evaluations/live", params=query).json()
    (first,) = page["live_evaluations"]
    assert live.path.endswith(first["live_id"])
    rest = served.client.get("/evaluations/live", params={**query, "cursor": page["next_cursor"]}).json()
    assert (rest["live_evaluations"], rest["next_cursor"]) == ([second], None)
