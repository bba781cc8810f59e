"""Evaluations over HTTP: the paper's tables, options, reports, and what cannot be compared."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.storage.models import EvaluatedPosesRow
from app.trajectories.alignment import AlignmentOptions
from app.trajectories.evaluation import EvaluationOptions, evaluate
from app.trajectories.evaluation_record import record_of_evaluation
from app.trajectories.formats import csv_text
from app.trajectories.trajectory import Trajectory
from tests.api.serving import Served, assert_problem
from tests.api.test_trajectory_import import imported
from tests.trajectories.walks import START_S, noisy, walk

PAPER = Path(__file__).parents[2] / "examples" / "paper"
SYSTEMS = ("samsung-galaxy-s8-1", "samsung-galaxy-s8-2", "huawei-p10-1", "huawei-p10-2")
NEAREST = {"association": "nearest"}


@pytest.fixture(scope="module")
def site_id(served: Served) -> str:
    return served.new_site()


@pytest.fixture(scope="module")
def paper(served: Served, site_id: str) -> dict[str, str]:
    """The paper's trajectories by name."""
    return {
        name: imported(served, (PAPER / f"{name}.csv").read_bytes(), site_id=site_id, name=name)["trajectory_id"]
        for name in ("truth", *SYSTEMS)
    }


def sent(served: Served, site_id: str, trajectory: Trajectory, name: str) -> str:
    text = "".join(csv_text([trajectory]))
    return str(imported(served, text, site_id=site_id, name=name)["trajectory_id"])


@pytest.fixture(scope="module")
def walks(served: Served, site_id: str) -> tuple[str, str]:
    """A reference of a minute with covariances, and a system with errors of 0.2 m."""
    covariances = np.tile(np.diag([1e-6] * 6), (600, 1, 1))
    reference = walk(60.0, covariances=covariances)
    wrong = noisy(walk(60.0, 5.0), 0.2)
    return sent(served, site_id, reference, "truth"), sent(served, site_id, wrong, "system")


def evaluated(served: Served, **body: Any) -> dict[str, Any]:
    answer = served.client.post("/evaluations", json=body)
    assert answer.status_code == 201, answer.text
    made: dict[str, Any] = answer.json()
    return made


@pytest.fixture(scope="module")
def compared(served: Served, paper: dict[str, str]) -> dict[str, Any]:
    estimates = [paper[name] for name in SYSTEMS]
    return evaluated(served, reference_id=paper["truth"], estimate_ids=estimates, options=NEAREST, title="Table 4")


def test_the_papers_table_4_comes_out(compared: dict[str, Any]) -> None:
    rms = {
        system["name"]: (
            *system["metrics"]["accuracy"]["rms_m"][:2],
            system["metrics"]["accuracy"]["horizontal_m"]["rms"],
        )
        for system in compared["systems"]
    }
    np.testing.assert_allclose(rms["samsung-galaxy-s8-1"], (0.0650, 0.0543, 0.0847), atol=5e-5)
    assert (compared["metrics"], compared["series"]) == (None, None)
    assert len(compared["differences"]) == 6
    assert compared["systems"][0]["metrics"]["pairs"] == 20


def test_one_system_has_its_metrics_and_series_at_the_top(served: Served, walks: tuple[str, str]) -> None:
    reference_id, estimate_id = walks
    made = evaluated(served, reference_id=reference_id, estimate_id=estimate_id, options={"alignment": "se3"})
    assert made["metrics"] == made["systems"][0]["metrics"]
    assert made["metrics"]["alignment"]["kind"] == "se3"
    assert made["metrics"]["verdict"]["distinguishable"]
    series = made["series"]
    assert (series["every"], len(series["time_s"]), len(series["error_m"])) == (1, 300, 300)
    assert np.sqrt((np.array(series["error_m"]) ** 2).sum(axis=1).mean()) == pytest.approx(
        made["metrics"]["accuracy"]["spatial_m"]["rms"]
    )
    assert served.client.get(f"/evaluations/{made['evaluation_id']}").json() == made


def test_the_service_and_the_library_say_the_same(served: Served, walks: tuple[str, str]) -> None:
    made = evaluated(served, reference_id=walks[0], estimate_id=walks[1], options={"alignment": "posyaw"})
    mine = evaluate(walk(60.0), noisy(walk(60.0, 5.0), 0.2), EvaluationOptions(alignment=AlignmentOptions("posyaw")))
    told, expected = made["metrics"]["accuracy"], record_of_evaluation(mine)["accuracy"]
    for name in ("CE50_m", "CE95_m", "VE95_m", "SE95_m", "rms_m", "bias_m"):
        np.testing.assert_allclose(told[name], expected[name], atol=2e-6)  # files are written to the micrometre


def test_every_option_has_its_effect(served: Served, walks: tuple[str, str]) -> None:
    zones = [{"name": "east", "corners_m": [[0, -9], [9, -9], [9, 9], [0, 9]]}]
    options = {
        "association": "interpolate",
        "max_gap_s": 0.5,
        "course": "spline",
        "time_offset_s": "estimate",
        "alignment": "first_n",
        "first_n": 200,
        "rotation_from": "orientations",
        "lever_arm_m": [0.0, 0.1, 0.0],
        "floor_height_m": 3.0,
        "zones": zones,
        "bootstrap": {"resamples": 200, "confidence": 0.9, "block": 5, "seed": 7},
    }
    made = evaluated(served, reference_id=walks[0], estimate_id=walks[1], options=options)
    metrics = made["metrics"]
    assert metrics["time_offset"]["sigma_s"] > 0
    assert metrics["alignment"]["pairs_used"] == 200
    assert metrics["floor_detection_probability"] is not None
    assert set(metrics["zones"]) == {"east", "elsewhere"}
    assert metrics["intervals_m"]["rms"]["block"] == 5
    assert made["options"]["time_offset_s"] is None  # estimated
    assert made["options"]["zones"] == [{"name": "east", "corners_m": zones[0]["corners_m"]}]


def test_the_report_is_a_page_a_print_and_an_archive(served: Served, compared: dict[str, Any]) -> None:
    starts = {"html": b"<!DOCTYPE html>", "pdf": b"%PDF", "zip": b"PK"}
    for kind, path in compared["plots"].items():
        answer = served.client.get(path)
        assert answer.status_code == 200, answer.text
        assert answer.content.lower().startswith(starts[kind].lower())
        assert answer.headers["content-type"].startswith({"html": "text/html"}.get(kind, f"application/{kind}"))
        assert "frame-ancestors" in answer.headers["content-security-policy"]
    with zipfile.ZipFile(io.BytesIO(served.client.get(compared["plots"]["zip"]).content)) as archive:
        assert archive.testzip() is None


def test_lists_and_removal(served: Served, paper: dict[str, str], site_id: str) -> None:
    made = evaluated(served, reference_id=paper["truth"], estimate_id=paper[SYSTEMS[0]], options=NEAREST)
    listed = served.client.get("/evaluations", params={"site_id": site_id}).json()["evaluations"]
    (mine,) = [item for item in listed if item["evaluation_id"] == made["evaluation_id"]]
    assert mine["systems"][0]["pairs"] == 20
    assert mine["systems"][0]["CE95_m"] == made["metrics"]["accuracy"]["CE95_m"]
    first = served.client.get("/evaluations", params={"limit": 1}).json()
    assert first["next_cursor"] is not None
    path = f"/evaluations/{made['evaluation_id']}"
    assert served.client.delete(path).status_code == 204
    assert_problem(served.client.get(path), 404, "not-found")
    assert_problem(served.client.delete(path), 404, "not-found")
    with served.services.database.reading() as session:
        assert session.query(EvaluatedPosesRow).filter_by(evaluation_id=made["evaluation_id"]).count() == 0
    assert served.client.get(f"/trajectories/{paper['truth']}").status_code == 200


def test_an_evaluation_outlives_its_trajectories(served: Served, site_id: str, walks: tuple[str, str]) -> None:
    estimate_id = sent(served, site_id, noisy(walk(20.0), 0.1), "short")
    made = evaluated(served, reference_id=walks[0], estimate_id=estimate_id)
    assert served.client.delete(f"/trajectories/{estimate_id}").status_code == 204
    again = served.client.get(f"/evaluations/{made['evaluation_id']}").json()
    assert again["systems"][0]["trajectory_id"] is None
    assert again["metrics"] == made["metrics"]
    assert served.client.get(made["plots"]["html"]).status_code == 200


# What cannot be compared


def test_nothing_matched_says_why(served: Served, site_id: str, walks: tuple[str, str]) -> None:
    late = sent(served, site_id, walk(10.0).shifted(3600.0), "late")
    answer = served.client.post("/evaluations", json={"reference_id": walks[0], "estimate_id": late})
    problem = assert_problem(answer, 422, "nothing-matched")
    assert "time_offset_s=-3600" in problem["detail"]
    assert (problem["system"], problem["reference_from_s"]) == ("late", START_S)


def test_what_orientations_are_needed_for_is_said(served: Served, paper: dict[str, str]) -> None:
    options = {**NEAREST, "lever_arm_m": [0, 0, 0.1]}
    body = {"reference_id": paper["truth"], "estimate_id": paper[SYSTEMS[0]], "options": options}
    assert (
        "orientations" in assert_problem(served.client.post("/evaluations", json=body), 422, "invalid-input")["detail"]
    )


def test_other_sites_share_no_frame(served: Served, walks: tuple[str, str]) -> None:
    elsewhere = sent(served, served.new_site(), walk(10.0), "elsewhere")
    answer = served.client.post("/evaluations", json={"reference_id": walks[0], "estimate_id": elsewhere})
    assert "share no frame" in assert_problem(answer, 409, "conflict")["detail"]


@pytest.mark.parametrize(
    ("change", "status", "kind"),
    [
        ({"reference_id": "nowhere"}, 404, "not-found"),
        ({"estimate_id": "nowhere"}, 404, "not-found"),
        ({"estimate_id": None}, 422, "invalid-input"),
        ({"options": {"alignment": "rigid"}}, 422, "invalid-input"),
        ({"options": {"max_gap": 1}}, 422, "invalid-input"),
        ({"options": {"time_offset_s": "guess"}}, 422, "invalid-input"),
        ({"options": {"zones": [{"name": "a", "corners_m": [[0, 0], [1, 1]]}]}}, 422, "invalid-input"),
    ],
)
def test_a_wrong_wish_is_told(
    served: Served, walks: tuple[str, str], change: dict[str, Any], status: int, kind: str
) -> None:
    body = {"reference_id": walks[0], "estimate_id": walks[1], **change}
    assert_problem(served.client.post("/evaluations", json=body), status, kind)


def test_the_reference_is_no_system(served: Served, walks: tuple[str, str]) -> None:
    for estimates in ([walks[0]], [walks[1], walks[1]]):
        body = {"reference_id": walks[0], "estimate_ids": estimates}
        assert_problem(served.client.post("/evaluations", json=body), 422, "invalid-input")
