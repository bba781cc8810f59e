"""The demo is the whole product at once: the real service, over HTTP only, on the room that ships."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.cli import main

ROOM = Path(__file__).parents[2] / "examples" / "room"
ROOM_RMSE_M = 0.010


def test_the_room_is_surveyed_located_and_scored(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["demo", str(ROOM), "--json"]) == 0
    captured = capsys.readouterr()
    result = json.loads(captured.out)
    assert result["targets"] >= 35
    assert len(result["scores"]) == 8
    assert [score["reason"] for score in result["scores"] if score["reason"]] == ["no-targets"]
    assert result["rmse"]["xyz_m"] < ROOM_RMSE_M
    stages = {line.rpartition(" ")[0] for line in captured.err.splitlines()}
    assert {"uploading photographs", "locating snapshots"} < stages


def test_a_room_whose_control_is_nonsense_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for part in ("survey", "locate"):
        (tmp_path / part).mkdir()
        (tmp_path / part / "a.jpg").write_bytes(b"no picture")
    (tmp_path / "control_points.csv").write_text("a,b\n1,2\n")
    assert main(["demo", str(tmp_path)]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "control-points" in line
    assert "name,code,dot" in line
