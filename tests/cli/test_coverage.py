"""``scattermark coverage``: plans and maps, pictures, suggestions, refusals."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.cli import main
from app.cli.coverage import LIGHTS, OVERS
from app.geometry.map_file import MapFile, write_map
from app.planning import dot_errors, suggestions
from app.planning.plan_file import read_plan
from app.planning.planned_map import planned_map

PLAN = "{name: Office, room_m: [5, 4, 2.6], post: {count: 16}, view: {step_m: 1, headings: 4}}"


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    path = tmp_path / "office.yaml"
    path.write_text(PLAN)
    return path


def test_choices_are_the_library_s() -> None:
    assert (LIGHTS, OVERS) == (dot_errors.LIGHTS, suggestions.OVERS)


def test_a_plan_is_told_in_words_and_pictures(plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    svg, png, record = (tmp_path / f"office.{suffix}" for suffix in ("svg", "png", "json"))
    outs = [part for path in (svg, png, record) for part in ("--out", str(path))]
    assert main(["coverage", "--plan", str(plan), "--suggest", "1", *outs]) == 0
    told = capsys.readouterr().out
    assert "Office: 16 targets, 20 positions at 1.5 m" in told and "next target 1: wall " in told
    assert svg.read_bytes().startswith(b"<svg xmlns") and png.read_bytes().startswith(b"\x89PNG")
    assert len(json.loads(record.read_text())["positions"]) == 20


def test_a_map_among_a_plan_s_walls(plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "map.json"
    write_map(path, MapFile(planned_map(read_plan(plan))))
    arguments = ["coverage", "--map", str(path), "--walls", str(plan), "--height-m", "1.2", "--headings", "2", "--json"]
    assert main(arguments) == 0
    record = json.loads(capsys.readouterr().out)
    assert (record["height_m"], len(record["headings_deg"]), record["summary"]["positions"]) == (1.2, 2, 20)


def test_faults_are_one_line(plan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan.write_text(PLAN.replace("count", "number"))
    assert main(["coverage", "--plan", str(plan)]) == 1
    assert "office.yaml, line 1, post.number: there is no such field" in capsys.readouterr().err
    assert main(["coverage", "--plan", str(plan), "--walls", str(plan)]) == 1
