"""Snapshots located over HTTP: the pose, its row, its repeat, its camera."""

from __future__ import annotations

import io
import json
import uuid
from typing import Any

import httpx
import numpy as np
import pytest
from PIL import Image

from app.storage.snapshots import NotFoundPose
from app.storage.trajectories import TrajectoryRepository
from tests.api.conftest import SurveyedRoom
from tests.api.serving import ROOM, Served, assert_problem, room_photos

POSITION_LIMIT_M = 0.03  # three times what the whole room must reach as RMSE, for a single snapshot
CHI2_3_LIMIT = 30.0  # position error squared over its covariance: chance exceeds it once in 10^6

TRUTH = {shot["file"]: shot for shot in json.loads((ROOM / "locate" / "truth.json").read_text())["shots"]}
SNAPSHOTS = room_photos("locate")
LOCATABLE = [name for name, shot in TRUTH.items() if len(shot["visible"]) >= 2]


def without_exif(image: bytes, quarter_turns: int = 0) -> bytes:
    """The same pixels as PNG without a word about the camera, turned counter-clockwise."""
    pixels = np.rot90(np.asarray(Image.open(io.BytesIO(image))), quarter_turns)
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG", compress_level=1)
    return buffer.getvalue()


def position_error_m(answer: dict[str, Any], name: str) -> np.ndarray:
    return np.array(answer["position_m"]) - np.array(TRUTH[name]["position_m"])


def snapshot_rows(served: Served, trajectory_id: str) -> list[Any]:
    with served.services.database.reading() as session:
        return list(TrajectoryRepository(session).snapshots(trajectory_id, 1000))


@pytest.fixture(scope="module")
def answers(served: Served, room: SurveyedRoom) -> dict[str, httpx.Response]:
    return {name: served.locate(room.site_id, image, device_id="surveyor") for name, image in SNAPSHOTS.items()}


@pytest.mark.parametrize("name", LOCATABLE)
def test_a_snapshot_gets_its_pose(answers: dict[str, httpx.Response], room: SurveyedRoom, name: str) -> None:
    assert answers[name].status_code == 200, answers[name].text
    answer = answers[name].json()
    error_m = position_error_m(answer, name)
    assert np.linalg.norm(error_m) < POSITION_LIMIT_M
    covariance = np.array(answer["covariance"])
    assert error_m @ np.linalg.solve(covariance[:3, :3], error_m) < CHI2_3_LIMIT
    np.testing.assert_allclose(answer["position_sigma_m"], np.sqrt(np.diag(covariance)[:3]))
    assert (answer["site_id"], answer["map_version"], answer["camera_source"]) == (room.site_id, 1, "survey")
    assert answer["time_source"] == "server"
    assert sum(target["used"] for target in answer["targets"]) >= 2
    assert set(answer["timing_ms"]) == {"decode", "detect", "resect", "total"}
    assert np.linalg.norm(answer["orientation_xyzw"]) == pytest.approx(1.0)
    assert set(answer["angles_deg"]) == {"phi", "omega", "kappa"}


def test_the_rest_is_refused_or_honest(answers: dict[str, httpx.Response]) -> None:
    for name in SNAPSHOTS.keys() - set(LOCATABLE):
        if answers[name].status_code == 200:
            answer = answers[name].json()
            error_m = position_error_m(answer, name)
            covariance = np.array(answer["covariance"])[:3, :3]
            assert error_m @ np.linalg.solve(covariance, error_m) < CHI2_3_LIMIT
        else:
            problem = assert_problem(answers[name], 422, "not-located")
            assert problem["reason"]
            assert problem["advice"]


def test_every_answer_is_a_row_of_the_devices_trajectory(served: Served, answers: dict[str, httpx.Response]) -> None:
    bodies = [answer.json() for answer in answers.values()]
    (trajectory_id,) = {body["trajectory_id"] for body in bodies}
    rows = {row.pose_id: row for row in snapshot_rows(served, trajectory_id)}
    for body, answer in zip(bodies, answers.values(), strict=True):
        outcome = rows[body["pose_id"]].outcome
        assert isinstance(outcome, NotFoundPose) == (answer.status_code == 422)


def test_a_picture_without_targets_is_refused_and_recorded(served: Served, room: SurveyedRoom) -> None:
    noise = np.random.default_rng(1).integers(60, 200, (480, 640, 3), dtype=np.uint8)
    buffer = io.BytesIO()
    Image.fromarray(noise).save(buffer, "JPEG")
    problem = assert_problem(served.locate(room.site_id, buffer.getvalue()), 422, "not-located")
    assert problem["reason"] == "no-targets"
    assert problem["seen"]["targets"] == []
    assert problem["advice"]
    row = snapshot_rows(served, problem["trajectory_id"])[-1]
    assert (row.pose_id, row.outcome.reason) == (problem["pose_id"], "no-targets")


def test_the_raw_body_says_the_same_as_the_form(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    fields = {"site_id": room.site_id, "device_id": "phone-9", "captured_at": "1777627800.25"}
    raw = served.client.post("/locate", params=fields, content=snapshot).json()
    form = served.client.post("/locate", data=fields, files={"image": snapshot}).json()
    assert raw["pose_id"] != form["pose_id"]
    for name in ("position_m", "covariance", "targets", "captured_at", "trajectory_id", "time_source"):
        assert raw[name] == form[name]


def test_a_repeat_gets_the_first_answer(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    snapshot_id = str(uuid.uuid4())
    first = served.locate(room.site_id, snapshot, snapshot_id=snapshot_id)
    other = SNAPSHOTS[LOCATABLE[-1]]
    assert served.locate(room.site_id, other, snapshot_id=snapshot_id.upper()).json() == first.json()
    refused_id = str(uuid.uuid4())
    refused = served.locate(room.site_id, _blank(), snapshot_id=refused_id)
    assert refused.status_code == 422
    again = served.locate(room.site_id, snapshot, snapshot_id=refused_id)
    assert again.status_code == 422
    own = {"request_id"}  # each request has its own
    assert {name: value for name, value in again.json().items() if name not in own} == {
        name: value for name, value in refused.json().items() if name not in own
    }
    rows = snapshot_rows(served, first.json()["trajectory_id"])
    assert sum(row.heading.snapshot_id == snapshot_id for row in rows) == 1


def _blank() -> bytes:
    buffer = io.BytesIO()
    Image.new("RGB", (64, 48), (90, 90, 90)).save(buffer, "PNG")
    return buffer.getvalue()


def test_the_clients_clock_is_heard(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    answer = served.locate(
        room.site_id,
        snapshot,
        captured_at="2026-05-01T11:30:00+02:00",
        client_clock_offset_s="-1.5",
        client_clock_delay_s="0.01",
    ).json()
    assert (answer["captured_at"], answer["time_source"]) == ("2026-05-01T09:29:58.500000Z", "client")


def test_devices_have_trajectories_of_their_own(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    def trajectory(**fields: str) -> str:
        return str(served.locate(room.site_id, snapshot, **fields).json()["trajectory_id"])

    mine = trajectory(device_id="phone-1")
    assert trajectory(device_id="phone-1") == mine
    assert trajectory(device_id="phone-2") != mine
    assert trajectory(device_id="phone-2", trajectory_id=mine) == mine
    assert trajectory() not in (mine, trajectory(device_id="phone-2"))


def camera_source(answer: httpx.Response) -> str:
    assert answer.status_code == 200, answer.text
    return str(answer.json()["camera_source"])


def test_the_camera_is_the_best_that_is_known(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    cameras = served.client.get("/cameras", params={"site_id": room.site_id}).json()["cameras"]
    sent = {name: cameras[0][name] for name in ("width_px", "height_px", "fx", "fy", "cx", "cy", "dist")}
    client = json.dumps({**sent, "readout_s": 0.03})
    assert camera_source(served.locate(room.site_id, snapshot)) == "survey"
    assert camera_source(served.locate(room.site_id, snapshot, device_id="surveyor", camera=client)) == "survey"
    assert camera_source(served.locate(room.site_id, snapshot, device_id="another phone")) == "model"
    assert camera_source(served.locate(room.site_id, snapshot, device_id="another phone", camera=client)) == "client"
    named = served.locate(room.site_id, snapshot, device_id="another phone", camera_id=cameras[0]["camera_id"])
    assert camera_source(named) == "survey"
    assert camera_source(served.locate(room.site_id, without_exif(snapshot))) == "model"
    assert camera_source(served.locate(room.site_id, without_exif(snapshot), device_id="surveyor")) == "survey"


@pytest.mark.parametrize("quarter_turns", [1, 3])
def test_a_transposed_frame_is_tried_in_both_quarter_turns(
    served: Served, room: SurveyedRoom, snapshot: bytes, quarter_turns: int
) -> None:
    answer = served.locate(room.site_id, without_exif(snapshot, quarter_turns), device_id="surveyor")
    assert camera_source(answer) == "survey"
    upright = served.locate(room.site_id, snapshot, device_id="surveyor").json()
    distance_m = np.linalg.norm(np.array(answer.json()["position_m"]) - np.array(upright["position_m"]))
    # Both are within chance of the same place, whichever way the frame was held.
    assert distance_m < 5 * (
        np.linalg.norm(upright["position_sigma_m"]) + np.linalg.norm(answer.json()["position_sigma_m"])
    )


def test_a_deactivated_map_is_not_used(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    job = served.build(room.survey_id, exclude={"images": ["IMG_0005.jpg"]})
    try:
        assert served.locate(room.site_id, snapshot).json()["map_version"] == job["result"]["map_version"]
    finally:
        served.client.post(f"/sites/{room.site_id}/maps/1/activate")
    assert served.locate(room.site_id, snapshot).json()["map_version"] == 1
