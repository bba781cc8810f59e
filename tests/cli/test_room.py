"""A room's folder is read as it is documented, and anything else is named."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from app.cli.room import has_truth, open_room, true_dots_m, true_shots
from app.errors import InvalidInput

ROOM = Path(__file__).parents[2] / "examples" / "room"


def test_the_room_that_ships() -> None:
    room = open_room(ROOM)
    assert (len(room.survey), len(room.snapshots), room.plate_u_m) == (16, 8, 0.014)
    assert has_truth(room)
    assert len(true_dots_m(room)) == 40


def test_its_truth_projects_onto_itself() -> None:
    """Camera, poses and dots of the truth files agree to their rounding, so frames and orders are read rightly."""
    truth, dots_m = true_shots(ROOM / "survey"), true_dots_m(open_room(ROOM))
    plates = 0
    for shot in truth.shots.values():
        for plate in shot.plates:
            if plate.code is None:
                continue
            seen_px = truth.camera.project(shot.site_from_cam.inverse().apply(dots_m[plate.code]))
            np.testing.assert_allclose(seen_px, plate.dots_px, atol=2e-3)
            plates += 1
    assert plates == 175


def test_the_caller_knows_the_size_better() -> None:
    assert open_room(ROOM, 0.02).plate_u_m == 0.02


def test_a_room_without_truth_is_a_room(tmp_path: Path) -> None:
    for part in ("survey", "locate"):
        (tmp_path / part).mkdir()
        (tmp_path / part / "a.jpg").touch()
    (tmp_path / "control_points.csv").touch()
    room = open_room(tmp_path)
    assert not has_truth(room)
    assert room.plate_u_m == 0.014


@pytest.mark.parametrize("missing", ["survey", "locate", "control_points.csv"])
def test_what_is_missing_is_named(tmp_path: Path, missing: str) -> None:
    for part in {"survey", "locate", "control_points.csv"} - {missing}:
        (tmp_path / part).mkdir()
    with pytest.raises(InvalidInput, match=f"{missing} is missing"):
        open_room(tmp_path)


@pytest.mark.parametrize("text", ["{", "{}", '{"camera": 1, "shots": []}', "[]"])
def test_another_truth_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "truth.json").write_text(text)
    with pytest.raises(InvalidInput, match=r"truth\.json"):
        true_shots(tmp_path)


def test_missing_truth_is_named(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=r"truth\.json: No such file"):
        true_shots(tmp_path)


def test_targets_of_another_form_are_refused(tmp_path: Path) -> None:
    for part in ("survey", "locate"):
        (tmp_path / part).mkdir()
        (tmp_path / part / "a.jpg").touch()
    (tmp_path / "control_points.csv").touch()
    (tmp_path / "targets_truth.json").write_text(json.dumps({"u_m": 0.01, "targets": [{"code": 1, "dots_m": [1]}]}))
    with pytest.raises(InvalidInput, match="not the truth of targets"):
        true_dots_m(open_room(tmp_path))
