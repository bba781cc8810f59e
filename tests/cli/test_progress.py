"""Without a terminal progress is a few lines on standard error."""

from __future__ import annotations

import pytest

from app.cli.progress import LINES_PER_STAGE, progress


def lines_of(capsys: pytest.CaptureFixture[str]) -> list[str]:
    captured = capsys.readouterr()
    assert captured.out == ""
    return captured.err.splitlines()


def test_a_few_lines_per_stage_and_the_last_one(capsys: pytest.CaptureFixture[str]) -> None:
    with progress() as report:
        for done in range(101):
            report("detecting", done, 100)
    lines = lines_of(capsys)
    assert lines[0] == "detecting 0/100"
    assert lines[-1] == "detecting 100/100"
    assert len(lines) == 1 + LINES_PER_STAGE


def test_stages_follow_each_other(capsys: pytest.CaptureFixture[str]) -> None:
    with progress() as report:
        report("one", 1, 1)
        report("one", 1, 1)
        report("two", 0, 0)
        report("two", 0, 0)
    assert lines_of(capsys) == ["one 1/1", "two"]
