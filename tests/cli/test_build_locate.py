"""The room that ships, from photographs to poses without the service, and what is said of bad input on the way."""

from __future__ import annotations

import io
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from app.cli import main
from app.cli.room import open_room, true_shots

ROOM = Path(__file__).parents[2] / "examples" / "room"
GROSS_SIGMAS = 5.0  # a position farther off than this contradicts its own covariance, whatever its noise
ROOM_RMSE_M = 0.010


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("built")
    control = str(ROOM / "control_points.csv")
    arguments = ["--control", control, "--out", str(folder / "map.json"), "--report", str(folder / "report.json")]
    assert main(["build", str(ROOM / "survey"), *arguments]) == 0
    return folder


def located(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    main(["locate", *arguments, "--json"])
    records: list[dict[str, Any]] = json.loads(capsys.readouterr().out)
    return records


def test_map_and_report_are_written(built: Path) -> None:
    content = json.loads((built / "map.json").read_text())
    assert (content["code_family"], content["plate_u_m"]) == ("golay", 0.014)
    assert len(content["targets"]) >= 35
    assert len(content["cameras"]) == 1
    assert json.loads((built / "report.json").read_text())


def test_snapshots_are_where_they_were_taken(built: Path, capsys: pytest.CaptureFixture[str]) -> None:
    records = located([str(ROOM / "locate"), "--map", str(built / "map.json")], capsys)
    truth = true_shots(ROOM / "locate").shots
    refused = [record["photo"] for record in records if "reason" in record]
    assert refused == [name for name, shot in truth.items() if not shot.plates]
    errors_m = []
    for record in records:
        if "reason" in record:
            continue
        error_m = np.array(record["position_m"]) - truth[record["photo"]].site_from_cam.position_m
        assert (np.abs(error_m) < GROSS_SIGMAS * np.array(record["position_sigma_m"])).all()
        errors_m.append(error_m)
    assert np.sqrt(np.square(errors_m).sum(axis=1).mean()) < ROOM_RMSE_M


@pytest.mark.parametrize("suffix", [".csv", ".tum"])
def test_located_snapshots_are_a_trajectory_in_the_order_of_their_times(
    suffix: str, built: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / f"walk{suffix}"
    snapshots = [str(path) for path in reversed(open_room(ROOM).snapshots)]
    records = located([*snapshots, "--map", str(built / "map.json"), "--trajectory", str(out)], capsys)
    assert main(["evaluate", str(out), str(out), "--association", "nearest", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)
    rows = out.read_text().splitlines()[1 if suffix == ".csv" else 0 :]
    rows = [row for row in rows if not row.startswith("#")]
    assert len(rows) == sum("reason" not in record for record in records)


def test_what_cannot_be_a_trajectory_is_said_before_anything_is_located(
    built: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    named = ["--map", str(built / "map.json"), "--trajectory", str(tmp_path / "walk.xml")]
    assert main(["locate", str(ROOM / "locate"), *named]) == 1
    assert ".csv or .tum" in capsys.readouterr().err


def test_a_photograph_without_a_time_has_no_place_in_a_trajectory(
    built: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bare = tmp_path / "bare.jpg"
    bare.write_bytes(without_metadata((ROOM / "locate" / "IMG_0000.jpg").read_bytes()))
    camera = tmp_path / "camera.json"
    camera.write_text(
        json.dumps({"width_px": 1280, "height_px": 720, "fx": 921.6, "fy": 921.6, "cx": 643.1, "cy": 357.4})
    )
    out = tmp_path / "walk.csv"
    named = ["--map", str(built / "map.json"), "--camera", str(camera), "--trajectory", str(out)]
    assert main(["locate", str(bare), *named]) == 1
    assert "does not tell when it was taken" in capsys.readouterr().err
    assert not out.exists()


def without_metadata(jpeg: bytes) -> bytes:
    out = io.BytesIO()
    Image.open(io.BytesIO(jpeg)).save(out, "JPEG", quality=95)
    return out.getvalue()


def test_the_published_method_builds_a_map_from_base_dots_alone(
    built: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    control = ["--control", str(ROOM / "control_points.csv"), "--out", str(tmp_path / "map.json")]
    assert main(["build", str(ROOM / "survey"), *control, "--detector", "paper", "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["report"]["unoriented"] == []
    published, by_default = (json.loads((folder / "map.json").read_text())["targets"] for folder in (tmp_path, built))
    assert {target["code"] for target in published} <= {target["code"] for target in by_default}
    # It misses what is seen from too near the wall; two thirds of the plates are carried by three photographs.
    assert len(published) >= 0.6 * len(by_default)


def test_a_camera_that_the_user_describes_is_used(
    built: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    camera = {"width_px": 1280, "height_px": 720, "fx": 921.6, "fy": 921.6, "cx": 643.1, "cy": 357.4}
    path = tmp_path / "camera.json"
    path.write_text(json.dumps(camera))
    snapshot = str(open_room(ROOM).snapshots[0])
    (record,) = located([snapshot, "--map", str(built / "map.json"), "--camera", str(path)], capsys)
    assert record["camera_source"] == "client"
    path.write_text(json.dumps({"fx": 900.0}))
    assert main(["locate", snapshot, "--map", str(built / "map.json"), "--camera", str(path)]) == 1
    assert "describes no camera" in capsys.readouterr().err


def test_one_bad_photograph_is_named_and_nothing_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    photos = tmp_path / "photos"
    photos.mkdir()
    shutil.copy(open_room(ROOM).survey[0], photos / "good.jpg")
    (photos / "cut.jpg").write_bytes(open_room(ROOM).survey[1].read_bytes()[:5000])
    assert main(["build", str(photos), "--out", str(tmp_path / "map.json")]) == 1
    assert "cut.jpg" in capsys.readouterr().err.splitlines()[-1]
    assert not (tmp_path / "map.json").exists()


def test_bad_control_points_are_named_by_row(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    control = tmp_path / "points.csv"
    control.write_text((ROOM / "control_points.csv").read_text().replace("2.4788", "2,4788"))
    assert main(["build", str(ROOM / "survey"), "--control", str(control), "--out", str(tmp_path / "map.json")]) == 1
    assert "row 1" in capsys.readouterr().err
