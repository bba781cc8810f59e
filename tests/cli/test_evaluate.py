"""The paper's tables on the command line, and what a user gets who makes a mistake."""

from __future__ import annotations

import json
from pathlib import Path
from typing import get_args

import pytest

from app.cli import evaluate, main
from app.trajectories.alignment import AlignmentKind
from app.trajectories.association import Association
from app.trajectories.reading.any_file import READERS, format_of
from app.trajectories.reading.table import UnreadableTrajectory
from app.trajectories.reading.time_units import PER_SECOND

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
    assert set(evaluate.FORMATS) == set(READERS)
    assert set(evaluate.UNITS) == set(PER_SECOND)
    assert get_args(Association) == evaluate.ASSOCIATIONS
    assert get_args(AlignmentKind) == evaluate.ALIGNMENTS


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
