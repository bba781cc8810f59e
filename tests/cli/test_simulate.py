"""A plan to a room on disk, and from there to a map and poses, as somebody at the command line does it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from app.cli.progress import Report
from app.cli.room import has_truth, open_room, true_dots_m, true_shots
from app.planning.simulation_plan import read_simulation
from app.trajectories.reading.any_file import read_trajectory

PLAN = """\
room_m: [2.6, 2.6, 2.4]
u_mm: 20
post: {count: 12, walls: [south, west], heights_m: [0.8, 1.8]}
camera: {width_px: 640, height_px: 480}
path:
  survey:
    - at_m: [2.2, 1.3, 1.1]
      headings_deg: [185, 215]
    - at_m: [1.3, 2.2, 1.7]
      headings_deg: [240, 270]
    - at_m: [2.3, 2.2, 1.4]
      headings_deg: [200, 225, 250]
    - {at_m: [2.0, 1.8, 1.6], look_at_m: [0.3, 0.3, 1.3], roll_deg: 90}
    - {at_m: [1.7, 2.3, 1.2], look_at_m: [0.6, 0.3, 1.3]}
  locate:
    - {at_m: [2.1, 2.0, 1.5], look_at_m: [0.4, 0.4, 1.3]}
  walk: {waypoints_m: [[2.2, 1.6], [1.7, 2.2]], look_at_m: [0.2, 0.2, 1.3], every_s: 0.5}
control: {control: 3, check: 2}
"""


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plan") / "corner.yaml"
    path.write_text(PLAN)
    return path


@pytest.fixture(scope="module")
def folder(plan: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("simulated") / "room"
    assert main(["simulate", str(plan), "--out", str(out), "--workers", "2"]) == 0
    return out


def test_the_folder_is_a_room_with_truth(folder: Path) -> None:
    room = open_room(folder)
    assert has_truth(room) and room.plate_u_m == 0.02 and len(true_dots_m(room)) == 12
    assert [len(room.survey), len(room.snapshots)] == [9, 3]
    for part, photos in (("survey", room.survey), ("locate", room.snapshots)):
        assert sorted(true_shots(folder / part).shots) == [path.name for path in photos]
    assert sorted(path.name for path in folder.parent.iterdir()) == ["room"]


def test_photographs_do_not_depend_on_who_renders_them(folder: Path, plan: Path) -> None:
    simulation = read_simulation(plan)
    for shot, part in ((simulation.survey[4], "survey"), (simulation.snapshots[2], "locate")):
        assert (folder / part / shot.stop.name).read_bytes() == simulation.photograph(shot).jpeg


def test_the_walk_is_there_to_be_evaluated_against(folder: Path) -> None:
    shots = true_shots(folder / "locate").shots
    for name in ("walk.tum", "walk.csv"):
        walk = read_trajectory((folder / "locate" / name).read_bytes()).trajectory
        assert walk.positions_m == pytest.approx(
            np.array([shots[f"WALK_000{index}.jpg"].site_from_cam.position_m for index in range(2)]), abs=1e-6
        )


def test_the_room_is_surveyed_and_snapshots_located_to_their_truth(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target_map, control = str(tmp_path / "map.json"), str(folder / "control_points.csv")
    assert main(["build", str(folder / "survey"), "--control", control, "--out", target_map, "--u-mm", "20"]) == 0
    capsys.readouterr()
    assert main(["locate", str(folder / "locate"), "--map", target_map, "--json"]) == 0
    shots = true_shots(folder / "locate").shots
    for located in json.loads(capsys.readouterr().out):
        error_m = np.array(located["position_m"]) - shots[located["photo"]].site_from_cam.position_m
        # Three coordinates at five sigmas, the map's own error (1 mm of three control points) beside the pose's.
        assert np.linalg.norm(error_m) < 5 * np.hypot(np.linalg.norm(located["position_sigma_m"]), 0.002)


def test_machines_are_told_what_was_made(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tiny = tmp_path / "tiny.yaml"
    tiny.write_text(PLAN.replace("width_px: 640, height_px: 480", "width_px: 160, height_px: 120"))
    assert main(["simulate", str(tiny), "--out", str(tmp_path / "room"), "--seed", "9", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["seed"], told["targets"], told["survey"], told["locate"]) == (9, 12, 9, 3)
    assert told["render_cpu_s"] > 0 and set(told["seldom_seen"]) <= set(true_dots_m(open_room(tmp_path / "room")))


def test_a_folder_that_is_there_is_not_touched(plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert main(["simulate", str(plan), "--out", str(tmp_path)]) == 1
    assert "is there already" in capsys.readouterr().err and [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_what_is_interrupted_leaves_nothing(plan: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(_: str, done: int, __: int) -> None:
        if done:
            raise KeyboardInterrupt

    @contextmanager
    def interrupted() -> Iterator[Report]:
        yield stop

    monkeypatch.setattr("app.cli.simulate.progress", interrupted)
    assert main(["simulate", str(plan), "--out", str(tmp_path / "room"), "--workers", "1"]) == 130
    assert not list(tmp_path.iterdir())


def test_a_bad_plan_leaves_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text(PLAN.replace("every_s: 0.5", "every_s: soon"))
    assert main(["simulate", str(bad), "--out", str(tmp_path / "room")]) == 1
    assert "bad.yaml, line 17, path.walk.every_s: a number is needed" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["bad.yaml"]
