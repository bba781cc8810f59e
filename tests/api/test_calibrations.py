"""A phone that the survey never saw is calibrated by photographs of the mapped room, and then located with that."""

from __future__ import annotations

from typing import Any

import httpx
import numpy as np
import pytest

from app.planning.synthetic import RenderedPhoto
from benchmarks.new_phone import new_phone, photographs, stations_of
from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem, room_photos

PHONE = new_phone(960, 720)
PHOTOS = 7
SURE = 5.0  # standard deviations that no honest estimate is off


@pytest.fixture(scope="module")
def taken() -> list[RenderedPhoto]:
    return photographs(PHONE, stations_of(PHOTOS, seed=3), seed=3)


def asked(served: Served, site_id: str, photos: list[bytes], **fields: str) -> httpx.Response:
    images = [("images", (f"photo{index}.jpg", photo)) for index, photo in enumerate(photos)]
    return served.client.post("/cameras/calibrations", data={"site_id": site_id, **fields}, files=images)


@pytest.fixture(scope="module")
def calibrated(served: Served, room: SurveyedRoom, taken: list[RenderedPhoto]) -> dict[str, Any]:
    answer = asked(served, room.site_id, [photo.jpeg for photo in taken[:-1]], device_id="phone-9", readout_s="0.02")
    assert answer.status_code == 202, answer.text
    job = served.wait(answer.json()["job_id"])
    assert job["state"] == "succeeded", job["error"]
    return job["result"]


def test_the_result_is_the_phones_camera(calibrated: dict[str, Any]) -> None:
    truth = PHONE.camera.intrinsics
    sigmas = np.sqrt(np.diag(np.array(calibrated["covariance"])))
    found = np.array([calibrated[name] for name in ("fx", "fy", "cx", "cy")] + list(calibrated["dist"]))
    assert (np.abs(found - truth) < SURE * sigmas).all()
    assert sigmas[0] < 0.003 * truth[0]
    assert (calibrated["width_px"], calibrated["height_px"]) == (960, 720)
    photographs = calibrated["photographs"]
    assert [photo["name"] for photo in photographs] == [f"photo{index}.jpg" for index in range(PHOTOS - 1)]
    # Residuals of all coordinates are those of the photographs together: no more than the worst, no less than the best.
    rms_px = [photo["rms_residual_px"] for photo in photographs]
    assert min(rms_px) < calibrated["rms_residual_px"] < max(rms_px)
    assert all(photo["targets"] > 0 for photo in photographs)
    assert "report_url" not in calibrated


def test_the_camera_is_listed_with_its_device(served: Served, room: SurveyedRoom, calibrated: dict[str, Any]) -> None:
    (camera,) = served.client.get("/cameras", params={"device_id": "phone-9"}).json()["cameras"]
    assert camera["camera_id"] == calibrated["camera_id"]
    assert (camera["source"], camera["site_id"], camera["readout_s"]) == ("calibration", room.site_id, 0.02)
    assert camera["make"] == PHONE.imaging.make


def test_snapshots_of_the_phone_are_located_by_it_and_those_of_another_unit_less_surely(
    served: Served, room: SurveyedRoom, calibrated: dict[str, Any], taken: list[RenderedPhoto]
) -> None:
    assert calibrated["camera_id"]
    snapshot, truth_m = taken[-1].jpeg, taken[-1].site_from_cam.position_m
    sigmas_m = {}
    for device_id, source in (("phone-9", "calibration"), ("phone-10", "model")):
        located = served.locate(room.site_id, snapshot, device_id=device_id).json()
        assert located["camera_source"] == source
        sigma_m = np.array(located["position_sigma_m"])
        assert (np.abs(np.array(located["position_m"]) - truth_m) < SURE * sigma_m).all()
        sigmas_m[source] = np.linalg.norm(sigma_m)
    assert sigmas_m["calibration"] < sigmas_m["model"]


def test_photographs_of_a_survey_give_the_same_camera_and_a_camera_is_forgotten(
    served: Served, room: SurveyedRoom, calibrated: dict[str, Any], taken: list[RenderedPhoto]
) -> None:
    survey_id = served.new_survey(room.site_id, note="photographs that calibrate a camera")
    fields = {"survey_id": survey_id, "device_id": "phone-12"}
    assert_problem(asked(served, room.site_id, [], **fields), 422, "invalid-input")  # it has none yet
    for index, photo in enumerate(taken[:-1]):
        assert served.put_photo(survey_id, f"photo{index}.jpg", photo.jpeg).status_code == 201
    assert_problem(asked(served, room.site_id, [taken[0].jpeg], **fields), 422, "invalid-input")
    assert_problem(asked(served, served.new_site(), [], **fields), 404, "not-found")
    job = served.wait(asked(served, room.site_id, [], **fields).json()["job_id"])
    assert job["survey_id"] == survey_id
    assert [job["result"][name] for name in ("fx", "cx")] == pytest.approx([calibrated[name] for name in ("fx", "cx")])
    path = f"/cameras/{job['result']['camera_id']}"
    assert served.locate(room.site_id, taken[-1].jpeg, device_id="phone-12").json()["camera_source"] == "calibration"
    assert served.client.delete(path).status_code == 204
    assert served.client.get("/cameras", params={"device_id": "phone-12"}).json()["cameras"] == []
    assert served.locate(room.site_id, taken[-1].jpeg, device_id="phone-12").json()["camera_source"] == "model"
    assert_problem(served.client.delete(path), 404, "not-found")


def test_what_cannot_be_right_is_refused_at_once_and_leaves_nothing(
    served: Served, room: SurveyedRoom, taken: list[RenderedPhoto]
) -> None:
    jpegs = [photo.jpeg for photo in taken]
    surveys = served.client.get(f"/sites/{room.site_id}/surveys").json()["surveys"]
    assert_problem(asked(served, room.site_id, jpegs[:2]), 422, "invalid-input")
    assert_problem(asked(served, "nowhere", jpegs), 404, "not-found")
    assert_problem(asked(served, served.new_site(), jpegs), 409, "conflict")
    assert_problem(asked(served, room.site_id, [*jpegs, b"no photograph"]), 415, "bad-photo")
    assert_problem(asked(served, room.site_id, jpegs, readout_s="-1"), 422, "invalid-input")
    assert served.client.get(f"/sites/{room.site_id}/surveys").json()["surveys"] == surveys


def test_photographs_that_carry_no_calibration_end_the_job_with_advice(served: Served, room: SurveyedRoom) -> None:
    without_targets = room_photos("locate")["IMG_0005.jpg"]
    job = served.wait(asked(served, room.site_id, [without_targets] * 5).json()["job_id"])
    assert (job["state"], job["error"]["reason"]) == ("failed", "no-targets")
    assert job["error"]["type"].endswith("calibration-failed")


def test_a_calibration_is_cancelled(served: Served, room: SurveyedRoom, taken: list[RenderedPhoto]) -> None:
    before = len(served.client.get("/cameras", params={"device_id": "phone-11"}).json()["cameras"])
    job_id = asked(served, room.site_id, [photo.jpeg for photo in taken], device_id="phone-11").json()["job_id"]
    assert served.client.post(f"/jobs/{job_id}/cancel").json()["state"] == "cancelled"
    assert served.wait(job_id)["state"] == "cancelled"
    assert len(served.client.get("/cameras", params={"device_id": "phone-11"}).json()["cameras"]) == before == 0
