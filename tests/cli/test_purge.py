from __future__ import annotations

import json
import os
import time
from pathlib import Path

import pytest

from app.cli import main
from app.storage.photo_store import open_photo_store, place_of
from tests.services.backup_scene import jpeg, sha256_of


@pytest.fixture
def orphan(tmp_path: Path) -> Path:
    """A photograph of yesterday that nothing refers to, in an installation without anything else."""
    assert main(["migrate", "--data-dir", str(tmp_path)]) == 0
    data = jpeg(1)
    open_photo_store(str(tmp_path / "photographs")).put(sha256_of(data), data)
    place = tmp_path / "photographs" / place_of(sha256_of(data))
    yesterday_s = time.time() - 86400.0
    os.utime(place, (yesterday_s, yesterday_s))
    return place


def test_what_would_be_removed_is_said_and_stays(
    orphan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert main(["purge", "--dry-run", "--json", "--data-dir", str(tmp_path)]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report == {
        "dry_run": True,
        "expired_snapshots": 0,
        "orphan_photographs": 1,
        "orphan_bytes": orphan.stat().st_size,
        "stray_detections": 0,
        "abandoned_files": 0,
    }


def test_what_nobody_needs_is_removed(orphan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["purge", "--data-dir", str(tmp_path)]) == 0
    assert "1 photographs that nothing refers to" in capsys.readouterr().out
    assert not orphan.exists()


def test_a_database_that_is_not_there_is_said_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["purge", "--data-dir", str(tmp_path)]) == 1
    assert "scattermark migrate" in capsys.readouterr().err
