"""The paper's tables on the command line, and what a user gets who makes a mistake."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from app.cli import evaluation_choices, evaluation_input, main
from app.services.geodesy import enu_from_site, geodetic
from app.services.trajectory_reading import ImportFormat
from app.storage.records import GeoAnchor
from app.trajectories.alignment import LEAST_PAIRS, AlignmentKind, RotationSource
from app.trajectories.association import Association
from app.trajectories.formats import csv_text, geojson_text
from app.trajectories.geopose import geopose_text
from app.trajectories.interpolation import Course
from app.trajectories.reading.any_file import format_of
from app.trajectories.reading.table import UnreadableTrajectory
from app.trajectories.reading.time_units import PER_SECOND
from app.trajectories.robotics_formats import euroc_text, kitti_text, kitti_times_text, tum_text
from tests.trajectories.walks import walk

PAPER = Path(__file__).parents[2] / "examples" / "paper"
TABLE_4 = {
    "samsung-galaxy-s8-1": (0.0650, 0.0543, 0.0847),
    "samsung-galaxy-s8-2": (0.0591, 0.0597, 0.0840),
    "huawei-p10-1": (0.0629, 0.0669, 0.0918),
    "huawei-p10-2": (0.0757, 0.0488, 0.0901),
}


def paper(*names: str) -> list[str]:
    return [str(PAPER / f"{name}.csv") for name in ("truth", *names)]


def test_the_papers_tables_from_its_coordinates(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["evaluate", *paper(*TABLE_4), "--association", "nearest", "--bands-m", "0.01", "0.1", "--json"]
    assert main(arguments) == 0
    answer = json.loads(capsys.readouterr().out)
    for name, rmse_m in TABLE_4.items():
        accuracy = answer["evaluations"][name]["accuracy"]
        assert (
            *[round(value, 4) for value in accuracy["rms_m"][:2]],
            round(accuracy["horizontal_m"]["rms"], 4),
        ) == rmse_m
    assert answer["counts_in_bands"]["samsung-galaxy-s8-1"][:2] == [[1, 18, 1], [3, 17, 0]]
    assert len(answer["differences"]) == 6


def test_people_get_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["evaluate", *paper("huawei-p10-1", "huawei-p10-2"), "--bands-m", "0.05"]) == 0
    text = capsys.readouterr().out
    for word in ("0.0918 m", "CE50", "EvAAL", "above 0.05", "neither is better beyond doubt"):
        assert word in text


def test_the_same_reading_whatever_the_dialect(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for suffix, first, line in (
        ("tum", "", "{0} {0} 1 2 0 0 0 1\n"),
        ("euroc", "", "{0}000000000,{0},1,2,1,0,0,0\n"),
        ("evaal", "", "{0};{0};1;0\n"),
        ("csv", "time_s,x_m,y_m\n", "{0},{0},1\n"),
    ):
        path = tmp_path / f"walk.{suffix}"
        path.write_text(first + "".join(line.format(second) for second in range(1, 5)))
        assert format_of(path.read_bytes()) == suffix
        assert main(["evaluate", str(path), str(path), "--json"]) == 0
        found = json.loads(capsys.readouterr().out)["evaluations"]["walk"]
        assert found["pairs"] == 4 and found["accuracy"]["SE95_m"] == 0.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time_s,x_m,y_m\n1,2,oops\n", "broken.csv: line 2, column y_m: 'oops' is no number"),
        ("time_s,x_m,y_m\n100001,2,3\n", "nothing matched within 1 s"),
        ("1 2\n", "no known format"),
    ],
)
def test_mistakes_are_one_clear_line(tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, words: str) -> None:
    broken = tmp_path / "broken.csv"
    broken.write_text(text)
    assert main(["evaluate", *paper(), str(broken)]) == 1
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1


def test_a_system_is_named_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["evaluate", *paper("huawei-p10-1", "huawei-p10-1")]) == 1
    assert "named twice" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["evaluate", *paper("huawei-p10-1"), "--time-offset-s", "soon"])
    assert "`estimate`" in capsys.readouterr().err


def test_the_choices_are_the_librarys() -> None:
    assert get_args(ImportFormat) == evaluation_input.FORMATS
    assert set(evaluation_input.UNITS) == set(PER_SECOND)
    assert get_args(Association) == evaluation_choices.ASSOCIATIONS
    assert get_args(Course) == evaluation_choices.COURSES
    assert get_args(AlignmentKind) == evaluation_choices.ALIGNMENTS
    assert get_args(RotationSource) == evaluation_choices.ROTATIONS
    assert evaluation_choices.LEAST_PAIRS == LEAST_PAIRS


def test_only_comments_are_no_format() -> None:
    with pytest.raises(UnreadableTrajectory, match="only comments"):
        format_of(b"# nothing\n")


@pytest.mark.parametrize(
    ("kind", "begin"), [("html", b"<!DOCTYPE html>"), ("pdf", b"%PDF"), ("zip", b"PK"), ("json", b"{")]
)
def test_a_report_is_what_its_name_ends_with(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str, begin: bytes
) -> None:
    path = tmp_path / f"report.{kind}"
    assert main(["evaluate", *paper("huawei-p10-1"), "--report", str(path)]) == 0
    assert path.read_bytes().lower().startswith(begin.lower())
    assert "0.0918 m" in capsys.readouterr().out


def test_a_report_of_no_known_kind_is_refused_before_any_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["evaluate", "nowhere.csv", "nowhere-else.csv", "--report", str(tmp_path / "report.doc")]) != 0
    assert ".html" in capsys.readouterr().err


ANCHOR = GeoAnchor(48.15, 11.57, 515.0, 30.0)


def written(folder: Path, name: str, pieces: Iterable[str]) -> str:
    path = folder / name
    path.write_text("".join(pieces))
    return str(path)


def test_every_format_that_is_written_is_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    true = replace(walk(10.0), floors=np.zeros(100, dtype=np.int64))
    on_earth = partial(geodetic, anchor=ANCHOR)
    reference = written(tmp_path, "truth.csv", csv_text([true]))
    files = {
        "tum": written(tmp_path, "a.tum", tum_text([true])),
        "euroc": written(tmp_path, "a-euroc.csv", euroc_text([true])),
        "geojson": written(tmp_path, "a.geojson", geojson_text([true], on_earth, {})),
        "geopose": written(tmp_path, "a.json", geopose_text([true], on_earth, enu_from_site(ANCHOR))),
    }
    anchor = ["--anchor", "48.15", "11.57", "515", "30"]
    assert main(["evaluate", reference, *files.values(), *anchor, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert [file["format"] for file in answer["files"]] == ["csv", *files]
    for found in answer["evaluations"].values():
        assert found["accuracy"]["SE95_m"] < 2e-3  # geopose counts milliseconds, degrees are written to 0.1 mm
        assert found["accuracy"]["rotation_rad"]["greatest"] < 1e-3
    written(tmp_path, "b.times", kitti_times_text([true]))
    kitti = written(tmp_path, "b.txt", kitti_text([true]))
    assert main(["evaluate", kitti, kitti, "--format", "kitti"]) == 0
    assert "kitti, 100 poses, the stamps count s since 1970" in capsys.readouterr().out
    assert main(["evaluate", files["tum"], reference, "--format", "kitti"]) == 1
    assert "a.times or times.txt beside it" in capsys.readouterr().err
    assert main(["evaluate", reference, files["geojson"]]) == 1
    assert "anchor" in capsys.readouterr().err


def test_choices_reach_the_evaluation(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    true = walk(20.0)
    late = replace(true, arrived_s=true.times_s + 0.25)
    files = [written(tmp_path, name, csv_text([poses])) for name, poses in (("truth.csv", true), ("said.csv", late))]
    zones = written(tmp_path, "zones.json", ['[{"name": "hall", "corners_m": [[-9, -9], [9, -9], [9, 9], [-9, 9]]}]'])
    choices = ["--zones", zones, "--alignment", "first_n", "--first-n", "12", "--course", "spline"]
    more = ["--rotation-from", "orientations", "--confidence", "0.5", "--resamples", "150", "--json"]
    assert main(["evaluate", *files, *choices, *more]) == 0
    found = json.loads(capsys.readouterr().out)["evaluations"]["said"]
    assert found["alignment"]["pairs_used"] == 12
    assert found["zones"]["hall"]["spatial_m"]["count"] == 200
    assert found["availability"]["latency_s"]["median"] == pytest.approx(0.25, abs=1e-5)
    report = tmp_path / "report.html"
    assert main(["evaluate", *files, "--zones", zones, "--report", str(report)]) == 0
    told = capsys.readouterr().out
    assert "0.250 s, 0.250 s" in told and "hall: SE50, SE95 (m)" in told
    assert "hall" in report.read_text() and "Latency, median, s" in report.read_text()


@pytest.mark.parametrize(
    "wrong", ["[]x", '[{"name": "hall"}]', '{"hall": 1}', '[{"name": "a", "corners_m": [[0, 0]]}]']
)
def test_zones_that_are_none_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str], wrong: str) -> None:
    assert main(["evaluate", *paper("huawei-p10-1"), "--zones", written(tmp_path, "zones.json", [wrong])]) == 1
    error = capsys.readouterr().err
    assert "zones.json" in error and error.count("\n") == 1
    for argument in (["--first-n", "2"], ["--confidence", "95"]):
        with pytest.raises(SystemExit):
            main(["evaluate", *paper("huawei-p10-1"), *argument])
