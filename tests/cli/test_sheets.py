import json
from pathlib import Path

import pytest

from app.cli import main
from app.cli.sheets import SIZES
from app.targets.paper import PAPERS


def test_sizes_are_the_papers_that_there_are() -> None:
    assert sorted(SIZES) == sorted(PAPERS)


def test_sheets_are_written_read_back_and_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "hall.pdf"
    assert main(["sheets", "--count", "3", "--size", "A5", "--title", "Hall", "--out", str(out)]) == 0
    assert out.read_bytes().startswith(b"%PDF")
    assert "3 targets of golay, u = 9 mm, 3 sheets of A5; print at 100 %" in capsys.readouterr().out


def test_machines_are_told_the_codes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "hall.pdf"
    assert main(["sheets", "--count", "2", "--taken", "889", "--out", str(out), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert len(told["codes"]) == 2 and 889 not in told["codes"] and told["sheets"] == 2 and told["u_mm"] == 14.0


@pytest.mark.parametrize(("suffix", "start"), [("svg", b"<svg"), ("png", b"\x89PNG")])
def test_single_targets_fill_a_folder(suffix: str, start: bytes, tmp_path: Path) -> None:
    assert main(["sheets", "--codes", "389,889", "--format", suffix, "--out", str(tmp_path / "plates")]) == 0
    files = sorted((tmp_path / "plates").iterdir())
    assert [file.name for file in files] == [f"target-389.{suffix}", f"target-889.{suffix}"]
    assert all(file.read_bytes().startswith(start) for file in files)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--codes", "388", "--out", "x.pdf"], "no codes of the family"),
        (["--count", "1", "--out", "x.png"], "is no .pdf"),
        (["--count", "1", "--u-mm", "30", "--out", "x.pdf"], "too large"),
        (["--codes", "abc", "--out", "x.pdf"], "names no codes"),
    ],
)
def test_bad_wishes_end_with_a_line_and_no_file(
    arguments: list[str], word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["sheets", *arguments]) == 1
    assert word in capsys.readouterr().err and not list(tmp_path.iterdir())
