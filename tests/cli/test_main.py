"""Bad input is one clear line and an exit status, never a traceback."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest

from app.cli import COMMANDS, main
from app.cli.arguments import DETECTORS, FAMILIES, STRICTNESSES, photo_files
from app.errors import InvalidInput
from app.targets.family import FAMILY_NAMES
from app.vision.detectors import DETECTOR_NAMES
from app.vision.reading import Strictness


def one_line(text: str) -> str:
    (line,) = text.splitlines()
    return line


@pytest.fixture
def empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("command", list(COMMANDS))
def test_every_command_explains_itself(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main([command, "--help"])
    assert end.value.code == 0
    assert f"scattermark {command}" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["detect", "absent.jpg"], "absent.jpg: No such file"),
        (["detect", "."], "Is a directory"),
        (["detect", "a.jpg", "--detector", "paper", "--strictness", "eager"], "mends no misread dot"),
        (["build", "absent.jpg", "--out", "map.json"], "there is no photograph absent.jpg"),
        (["build", ".", "--out", "map.json"], "holds no photograph"),
        (["locate", "absent.jpg", "--map", "absent.json"], "cannot read the map absent.json"),
        (["demo", "."], "is no room: survey is missing"),
        (["serve", "--host", "0.0.0.0"], "--insecure"),
        (["serve", "--port", "65536"], "ports go from 0 to 65535"),
    ],
)
@pytest.mark.usefixtures("empty_folder")
def test_bad_input_is_one_line(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 1
    line = one_line(capsys.readouterr().err)
    assert line.startswith(f"scattermark {arguments[0]}: ")
    assert words in line


def test_machines_get_the_error_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "notes.jpg"
    path.write_text("no picture")
    assert main(["detect", str(path), "--json"]) == 1
    record = json.loads(capsys.readouterr().out)
    assert record["error"] == "bad-photo"
    assert "notes.jpg" in record["detail"]


@pytest.mark.parametrize(
    "arguments", [[], ["fly"], ["build", "a.jpg"], ["build", "a.jpg", "--out", "m", "--u-mm", "0"]]
)
def test_wrong_arguments_end_with_two(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main(arguments)
    assert end.value.code == 2
    assert "usage: scattermark" in capsys.readouterr().err


def test_help_does_not_wait_for_the_library() -> None:
    code = (
        "import sys; from app.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: print(sorted({'cv2', 'scipy', 'fastapi', 'sqlalchemy'} & set(sys.modules)))"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.splitlines()[-1] == "[]"


def test_choices_are_the_librarys() -> None:
    assert FAMILIES == FAMILY_NAMES
    assert DETECTORS == DETECTOR_NAMES
    assert get_args(Strictness) == STRICTNESSES


def test_a_folder_stands_for_its_photographs(tmp_path: Path) -> None:
    for name in ("b.JPG", "a.png", "truth.json"):
        (tmp_path / name).touch()
    assert [path.name for path in photo_files([tmp_path])] == ["a.png", "b.JPG"]


def test_two_photographs_of_one_name_are_refused(tmp_path: Path) -> None:
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "a.jpg").touch()
    with pytest.raises(InvalidInput, match=r"come twice: a\.jpg"):
        photo_files([tmp_path / "one", tmp_path / "two"])
