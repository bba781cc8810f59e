"""The documents: they build with every link leading somewhere, and the tutorial's commands do what it says."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```(sh|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
WRITTEN = ("sheets.pdf", "coverage.svg", "seen.png", "map.json", "report.html", "truth.csv", "wifi.csv", "wifi.html")


def test_the_site_builds_and_all_links_lead_somewhere(tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-W",
        "ignore",
        "-m",
        "mkdocs",
        "build",
        "--strict",
        "--site-dir",
        str(tmp_path / "site"),
    ]
    built = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert built.returncode == 0, built.stderr
    page = (tmp_path / "site" / "tutorial" / "index.html").read_text()
    assert "From printing to an evaluation" in page
    # Whoever reads the documents asks no other host for their looks.
    assert not re.findall(r'(?:src|href)="https?://[^"]+\.(?:css|js|woff2?)"', page)


def blocks() -> list[tuple[str, str]]:
    return BLOCK.findall((ROOT / "docs" / "tutorial.md").read_text())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that holds the examples and nothing else, as a fresh clone would."""
    place = tmp_path_factory.mktemp("tutorial")
    (place / "examples").symlink_to(ROOT / "examples")
    return place


def test_the_tutorial_s_commands_run_as_they_stand(folder: Path) -> None:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for language, text in blocks():
        command = ["bash", "-e", "-c", text] if language == "sh" else [sys.executable, "-c", text]
        done = subprocess.run(command, cwd=folder, env={**os.environ, "PATH": path}, capture_output=True, text=True)
        assert done.returncode == 0, f"{text}\n{done.stdout}\n{done.stderr}"
    assert [name for name in WRITTEN if not (folder / "tutorial" / name).stat().st_size] == []
