"""Whatever comes in: a clear problem that says what to do, nothing half-written, the service still up."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import piexif
import pytest
from PIL import Image

from tests.api.bad_photos import BAD_PHOTOS, DAMAGED_PHOTOS, GOOD, encoded
from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served, assert_problem, room_control_points, room_photos

SURVEY = room_photos("survey")
APART = ("IMG_0000.jpg", "IMG_0002.jpg")  # the truth shows no target in both


@pytest.fixture(autouse=True)
def service_stays_up(served: Served) -> Iterator[None]:
    """After every test: ready, and no upload left half-way."""
    yield
    assert served.client.get("/readyz").status_code == 200
    assert list((served.settings.photographs_dir / "incoming").iterdir()) == []


@pytest.fixture
def survey_id(served: Served) -> str:
    return served.new_survey(served.new_site())


def photographs(served: Served) -> set[Path]:
    return {path for path in served.settings.photographs_dir.rglob("*") if path.is_file()}


# Photographs


@pytest.mark.parametrize("name", BAD_PHOTOS)
def test_a_survey_takes_no_bad_photograph(served: Served, survey_id: str, name: str) -> None:
    before = photographs(served)
    data, status = BAD_PHOTOS[name]
    answer = served.put_photo(survey_id, "photo.jpg", data)
    problem = answer.json()
    kind = "photo-too-large" if status == 413 else problem["type"].rsplit("/", 1)[1]
    assert kind in ("photo-too-large", "bad-photo", "unsupported-photo")
    assert_problem(answer, status, kind)
    assert problem["filename"] == "photo.jpg"
    assert served.client.get(f"/surveys/{survey_id}/images").json()["images"] == []
    assert photographs(served) == before


@pytest.mark.parametrize("name", [*BAD_PHOTOS, *DAMAGED_PHOTOS])
def test_no_bad_photograph_is_located(served: Served, room: SurveyedRoom, name: str) -> None:
    data, status = BAD_PHOTOS[name] if name in BAD_PHOTOS else (DAMAGED_PHOTOS[name], 415)
    form = served.locate(room.site_id, data)
    raw = served.client.post("/locate", params={"site_id": room.site_id}, content=data)
    for answer in (form, raw):
        assert answer.status_code == status, answer.text
        assert_problem(answer, status, answer.json()["type"].rsplit("/", 1)[1])


@pytest.mark.parametrize("size", [(1, 1), (3, 2), (1, 500)])
def test_a_tiny_picture_holds_no_target(served: Served, room: SurveyedRoom, size: tuple[int, int]) -> None:
    buffer = io.BytesIO()
    Image.new("RGB", size, (120, 60, 60)).save(buffer, "PNG")
    assert assert_problem(served.locate(room.site_id, buffer.getvalue()), 422, "not-located")["reason"] == "no-targets"


def test_a_photograph_too_many_bytes_large(served: Served, room: SurveyedRoom, survey_id: str) -> None:
    before = photographs(served)
    large = GOOD + bytes(served.settings.max_photo_bytes)
    answers = [
        served.put_photo(survey_id, "large.jpg", large),
        served.client.post("/locate", params={"site_id": room.site_id}, content=large),
        served.locate(room.site_id, large),
    ]
    for answer in answers:
        assert answer.status_code == 413, answer.text
        assert_problem(answer, 413, answer.json()["type"].rsplit("/", 1)[1])
    assert photographs(served) == before


def test_a_chunked_upload_too_large_is_stopped(served: Served, survey_id: str) -> None:
    def endless() -> Iterator[bytes]:
        yield GOOD
        for _ in range(served.settings.max_photo_bytes // 2**20 + 2):
            yield bytes(2**20)

    answer = served.client.put(f"/surveys/{survey_id}/images/endless.jpg", content=endless())
    assert_problem(answer, 413, answer.json()["type"].rsplit("/", 1)[1])
    assert served.client.get(f"/surveys/{survey_id}/images").json()["images"] == []


def test_an_upload_that_breaks_off_leaves_nothing(served: Served, survey_id: str) -> None:
    before = photographs(served)

    def breaking_off() -> Iterator[bytes]:
        yield GOOD[:50_000]
        raise ConnectionError("the phone left the room")

    with pytest.raises(ConnectionError):
        served.client.put(
            f"/surveys/{survey_id}/images/half.jpg",
            content=breaking_off(),
            headers={"Content-Length": str(len(GOOD))},
        )
    assert served.put_photo(survey_id, "whole.jpg", GOOD).status_code == 201
    names = [image["name"] for image in served.client.get(f"/surveys/{survey_id}/images").json()["images"]]
    assert names == ["whole.jpg"]
    assert len(photographs(served) - before) <= 1


# Requests


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", "/sites/{id}"),
        ("PATCH", "/sites/{id}"),
        ("DELETE", "/sites/{id}"),
        ("PUT", "/sites/{id}/control-points"),
        ("POST", "/sites/{id}/surveys"),
        ("GET", "/sites/{id}/targets"),
        ("GET", "/sites/{id}/report"),
        ("GET", "/sites/{id}/maps"),
        ("GET", "/surveys/{id}/images"),
        ("PUT", "/surveys/{id}/images/a.jpg"),
        ("POST", "/surveys/{id}/build"),
        ("GET", "/jobs/{id}"),
        ("POST", "/jobs/{id}/cancel"),
    ],
)
@pytest.mark.parametrize("unknown", ["nowhere", "00000000-0000-7000-8000-000000000000", "a%00b", "'; drop table sites"])
def test_what_does_not_exist_is_not_found(served: Served, method: str, path: str, unknown: str) -> None:
    bodies: dict[str, Any] = {"PATCH": {"json": {"name": "x"}}, "PUT": {"content": GOOD if "images" in path else "[]"}}
    answer = served.client.request(method, path.format(id=unknown), **bodies.get(method, {}))
    assert_problem(answer, 404, "not-found")


@pytest.mark.parametrize(
    ("fields", "field"),
    [
        ({"snapshot_id": "42"}, "snapshot_id"),
        ({"captured_at": "yesterday"}, "captured_at"),
        ({"captured_at": "nan"}, "captured_at"),
        ({"client_clock_offset_s": "soon"}, "client_clock_offset_s"),
        ({"client_clock_offset_s": "inf"}, "client_clock_offset_s"),
        ({"client_clock_delay_s": "-1"}, "client_clock_delay_s"),
        ({"device_id": "x" * 300}, "device_id"),
        ({"device_id": "a\0b"}, "device_id"),
        ({"camera": "no json"}, "camera"),
        ({"camera": "{}"}, "camera"),
        ({"camera": json.dumps({"width_px": 10, "height_px": 10, "fx": 0, "fy": 1, "cx": 1, "cy": 1})}, "fx"),
        (
            {"camera": json.dumps({"width_px": 1, "height_px": 1, "fx": 1, "fy": 1, "cx": 1, "cy": 1, "dist": [1]})},
            "dist",
        ),
    ],
)
def test_a_wrong_parameter_is_named(
    served: Served, room: SurveyedRoom, snapshot: bytes, fields: dict[str, str], field: str
) -> None:
    problem = assert_problem(served.locate(room.site_id, snapshot, **fields), 422, "invalid-input")
    assert field in problem["detail"]


def test_what_a_snapshot_names_must_exist(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    assert_problem(served.locate("nowhere", snapshot), 404, "not-found")
    assert_problem(served.locate(room.site_id, snapshot, trajectory_id="nowhere"), 404, "not-found")
    assert_problem(served.locate(room.site_id, snapshot, camera_id="nowhere"), 404, "not-found")
    assert_problem(served.locate(served.new_site(), snapshot), 409, "conflict")
    mine = served.locate(room.site_id, snapshot).json()["trajectory_id"]
    assert mine
    assert_problem(
        served.client.post("/locate", data={"site_id": room.site_id}, files={"photo": snapshot}), 422, "invalid-input"
    )
    assert_problem(served.client.post("/locate", files={"image": snapshot}), 422, "invalid-input")
    assert_problem(served.client.post("/locate", content=snapshot), 422, "invalid-input")
    torn = {"Content-Type": "multipart/form-data; boundary=x"}
    answer = served.client.post("/locate", content=b"--x\r\nContent-Dispo", headers=torn)
    assert answer.status_code in (400, 422)
    assert answer.headers["content-type"] == "application/problem+json"


def test_a_camera_of_another_cut_is_refused(served: Served, room: SurveyedRoom, snapshot: bytes) -> None:
    camera = {"width_px": 800, "height_px": 800, "fx": 700, "fy": 700, "cx": 400, "cy": 400}
    stripped = encoded(_pixels(snapshot), "PNG")
    answer = served.locate(room.site_id, stripped, device_id="a new phone", camera=json.dumps(camera))
    problem = assert_problem(answer, 422, "not-located")
    assert problem["reason"] == "unknown-camera"


def _pixels(image: bytes) -> Any:
    return np.asarray(Image.open(io.BytesIO(image)))


@pytest.mark.parametrize("body", [b"{", b"[1, 2", b"\xff\xfe", b"[" * 100_000, b'{"name": "\\ud800"}', b"null", b"3"])
def test_a_body_that_is_no_json_is_refused(served: Served, body: bytes) -> None:
    answer = served.client.post("/sites", content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code in (400, 422)
    assert answer.headers["content-type"] == "application/problem+json"


def test_a_text_too_large_is_refused(served: Served) -> None:
    url = f"/sites/{served.new_site()}/control-points"
    answer = served.client.put(url, content=b" " * (served.settings.max_text_bytes + 1))
    assert_problem(answer, 413, "too-large")


@pytest.mark.parametrize(
    ("path", "query"),
    [
        ("/sites", {"limit": "0"}),
        ("/sites", {"limit": "many"}),
        ("/sites", {"cursor": "made up"}),
        ("/sites/{site_id}/maps", {"cursor": "eA=="}),
        ("/sites/{site_id}/targets", {"version": "0"}),
        ("/sites/{site_id}/targets", {"version": "99999999999999999999"}),
        ("/cameras", {"device_id": ""}),
    ],
)
def test_a_wrong_query_is_refused(served: Served, room: SurveyedRoom, path: str, query: dict[str, str]) -> None:
    answer = served.client.get(path.format(site_id=room.site_id), params=query)
    if query == {"cursor": "eA=="}:  # a key of another list: it is a page all the same
        assert answer.status_code == 200
    else:
        assert_problem(answer, 422, "invalid-input")


# Control points


def control_rows() -> list[list[str]]:
    return [line.split(",") for line in room_control_points().splitlines()]


def as_csv(rows: list[list[str]]) -> str:
    return "\n".join(",".join(row) for row in rows)


def test_control_points_that_cannot_be_are_refused_at_once(served: Served, room: SurveyedRoom) -> None:
    url = f"/sites/{room.site_id}/control-points"
    before = served.client.get(url).json()
    header, *rows = control_rows()
    changed = [list(row) for row in rows]
    changed[1][3] = "4,46"
    in_line = [[*row[:3], str(index), "1.0", "1.0", *row[6:]] for index, row in enumerate(rows[:4])]
    refused = {
        "too few": as_csv([header, *rows[:2]]),
        "in one line": as_csv([header, *in_line]),
        "a dot twice": as_csv([header, *rows, ["again", *rows[0][1:]]]),
        "a name twice": as_csv([header, *rows, [rows[0][0], *rows[5][1:]]]),
        "a decimal comma": "\n".join([",".join(header), *(",".join(row) for row in changed)]),
        "an unknown code": as_csv([header, ["CP1", "7", *rows[0][2:]], *rows[1:]]),
        "no header": as_csv(rows),
        "semicolons": as_csv([header, *rows]).replace(",", ";"),
        "a picture": "\ufffd\ufffd",
    }
    for why, text in refused.items():
        problem = assert_problem(served.put_control_points(room.site_id, text), 422, "invalid-control-points")
        assert problem["detail"], why
    for body in (b"{}", b"[1]", b"[", b"\xff", b"[" * 100_000):
        answer = served.client.put(url, content=body, headers={"Content-Type": "application/json"})
        assert_problem(answer, 422, "invalid-control-points")
    answer = served.client.put(url, content=b"x", headers={"Content-Type": "application/xml"})
    assert_problem(answer, 415, "unsupported-media-type")
    assert served.client.get(url).json() == before


def new_room(served: Served, control_points: str | None, photos: dict[str, bytes]) -> str:
    site_id = served.new_site()
    if control_points is not None:
        assert served.put_control_points(site_id, control_points).status_code == 200
    survey_id = served.new_survey(site_id)
    for name, data in photos.items():
        assert served.put_photo(survey_id, name, data).status_code == 201
    return survey_id


def failed_build(served: Served, survey_id: str, **options: Any) -> dict[str, Any]:
    """The problem that ended a build; nothing of it is published."""
    job = served.build(survey_id, **options)
    assert job["state"] == "failed", job
    site_id = job["site_id"]
    assert served.client.get(f"/sites/{site_id}/maps").json()["maps"] == []
    assert served.client.get("/cameras", params={"site_id": site_id}).json()["cameras"] == []
    assert job["result"] is None
    problem: dict[str, Any] = job["error"]
    assert problem["status"] == 422
    assert len(problem["detail"]) > 20
    return problem


def test_swapped_control_points_are_found_and_named(served: Served) -> None:
    header, *rows = control_rows()
    swapped = [list(row) for row in rows]
    swapped[0][3:6], swapped[1][3:6] = rows[1][3:6], rows[0][3:6]
    problem = failed_build(served, new_room(served, as_csv([header, *swapped]), SURVEY))
    assert problem["type"].endswith("/invalid-control-points")
    assert "CP1" in problem["detail"]
    assert "CP2" in problem["detail"]


def test_a_mistyped_control_point_is_found_and_named(served: Served) -> None:
    header, *rows = control_rows()
    mistyped = [list(row) for row in rows]
    mistyped[2][4] = str(float(rows[2][4]) + 0.3)
    problem = failed_build(served, new_room(served, as_csv([header, *mistyped]), SURVEY))
    assert problem["type"].endswith("/invalid-control-points")
    assert "CP3" in problem["detail"]


# Surveys and builds


def test_a_survey_without_overlap_says_so(served: Served) -> None:
    problem = failed_build(served, new_room(served, None, {name: SURVEY[name] for name in APART}))
    assert problem["type"].endswith("/survey-failed")
    assert problem["reason"]


def test_a_survey_without_targets_says_so(served: Served) -> None:
    noise = {
        f"{seed}.jpg": encoded(np.random.default_rng(seed).integers(0, 255, (120, 160, 3), np.uint8), "JPEG")
        for seed in (1, 2)
    }
    problem = failed_build(served, new_room(served, None, noise))
    assert (problem["type"].rsplit("/", 1)[1], problem["reason"]) == ("survey-failed", "no-targets")


def test_a_damaged_photograph_does_not_end_a_survey(served: Served) -> None:
    survey_id = new_room(served, room_control_points(), {**SURVEY, "damaged.jpg": DAMAGED_PHOTOS["truncated jpeg"]})
    job = served.build(survey_id)
    assert job["state"] == "succeeded", job
    assert (job["result"]["photographs"], job["result"]["unoriented"]) == (len(SURVEY) + 1, 1)
    (left_out,) = served.client.get(job["result"]["report_url"]).json()["photographs_left_out"]
    assert left_out["name"] == "damaged.jpg"
    assert "truncated" in left_out["reason"]


def test_photographs_of_two_cameras_are_a_camera_each(served: Served) -> None:
    photos = {name: data if index % 2 else by_another_camera(data) for index, (name, data) in enumerate(SURVEY.items())}
    job = served.build(new_room(served, room_control_points(), photos))
    assert job["state"] == "succeeded", job
    cameras = served.client.get("/cameras", params={"site_id": job["site_id"]}).json()["cameras"]
    assert sorted((camera["model"], camera["width_px"]) for camera in cameras) == [("Other", 1120), ("Pixel 2", 1280)]


def by_another_camera(image: bytes) -> bytes:
    """The same view through a camera of fewer pixels and another name."""
    picture = Image.open(io.BytesIO(image))
    exif = piexif.load(image)
    exif["0th"][piexif.ImageIFD.Model] = b"Other"
    exif.pop("thumbnail", None)
    buffer = io.BytesIO()
    picture.resize((1120, 630), Image.Resampling.LANCZOS).save(buffer, "JPEG", quality=95, exif=piexif.dump(exif))
    return buffer.getvalue()


def test_a_build_that_cannot_be_is_refused_at_once(served: Served, room: SurveyedRoom, survey_id: str) -> None:
    url = f"/surveys/{survey_id}/build"
    assert "photographs" in assert_problem(served.client.post(url), 409, "conflict")["detail"]
    served.put_photo(survey_id, "a.jpg", GOOD)
    assert_problem(served.client.post(url), 409, "conflict")
    url = f"/surveys/{room.survey_id}/build"
    before = served.client.get(f"/sites/{room.site_id}/maps").json()

    def refused(body: dict[str, Any], status: int = 422, kind: str = "invalid-input") -> httpx.Response:
        answer = served.client.post(url, json=body)
        assert_problem(answer, status, kind)
        return answer

    refused({"exclude": {"images": ["nowhere.jpg"]}})
    refused({"exclude": {"codes": [7]}})
    refused({"exclude": {"codes": [10**30]}})
    refused({"exclude": {"control_points": ["nobody"]}})
    refused({"exclude": {"control_points": ["CP1", "CP2"]}}, kind="invalid-control-points")
    refused({"exclude": {"everything": True}})
    refused({"exclude": {"images": list(SURVEY)}}, 409, "conflict")
    refused({"strictness": "sloppy"})
    refused({"activate": "perhaps"})
    refused({"base_version": 0})
    refused({"base_version": 99}, 404, "not-found")
    refused({"speed": "fast"})
    assert served.client.get(f"/sites/{room.site_id}/maps").json() == before
