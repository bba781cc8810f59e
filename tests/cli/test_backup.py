"""backup, restore, export, import and doctor as commands: one line that says what happened, and the exit code."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.cli import main
from app.settings import Settings
from app.storage.database import Database
from app.storage.migrate import upgrade
from app.storage.photo_store import open_photo_store
from tests.services.backup_scene import PHOTOS, Scene, fill, rows_of, sha256_of


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(data_dir=tmp_path / "data")


@pytest.fixture
def scene(settings: Settings) -> Iterator[Scene]:
    settings.data_dir.mkdir(mode=0o700)
    database = Database(settings.sqlalchemy_url)
    upgrade(database)
    yield fill(database, settings.photographs_dir)
    database.close()


def test_a_backup_and_its_restoration(
    scene: Scene, settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, elsewhere = tmp_path / "b.zip", tmp_path / "elsewhere"
    assert main(["backup", str(file), "--data-dir", str(settings.data_dir)]) == 0
    out = capsys.readouterr()
    rows = sum(len(table) for table in rows_of(scene.database).values())
    assert out.out == f"{file}: {rows} rows and 3 photographs, {file.stat().st_size} bytes\n"
    assert "photographs 3/3" in out.err
    assert main(["restore", str(file), "--data-dir", str(elsewhere)]) == 0
    assert capsys.readouterr().out == f"restored {rows} rows and 3 photographs\n"
    restored = Database(Settings(data_dir=elsewhere).sqlalchemy_url)
    assert rows_of(restored)["snapshots"] == rows_of(scene.database)["snapshots"]
    restored.close()
    assert main(["restore", str(file), "--data-dir", str(elsewhere)]) == 1
    assert "not empty" in capsys.readouterr().err
    assert main(["restore", str(file), "--force", "--json", "--data-dir", str(elsewhere)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["photographs"], told["missing"], told["rows"]["snapshots"]) == (3, [], 3)


def test_a_backup_without_photographs(
    scene: Scene, settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "b.zip"
    assert main(["backup", str(file), "--no-photographs", "--json", "--data-dir", str(settings.data_dir)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["photographs"], told["lost"], told["rows"]["photographs"]) == (0, [], len(PHOTOS))
    assert main(["restore", str(file), "--data-dir", str(tmp_path / "elsewhere")]) == 0
    assert "made without photographs" in capsys.readouterr().out
    assert scene.site_id


def test_a_lost_photograph_fails_the_backup_that_is_written_all_the_same(
    scene: Scene, settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene.photos.delete(sha256_of(PHOTOS["IMG_0.jpg"]))
    assert main(["backup", str(tmp_path / "b.zip"), "--data-dir", str(settings.data_dir)]) == 1
    assert "1 photographs that the database names are lost" in capsys.readouterr().err
    assert main(["restore", str(tmp_path / "b.zip"), "--data-dir", str(tmp_path / "elsewhere")]) == 0
    assert "lost before the backup was made" in capsys.readouterr().out


def test_a_file_that_is_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["restore", str(tmp_path / "b.zip"), "--data-dir", str(tmp_path / "data")]) == 1
    assert "No such file" in capsys.readouterr().err


def test_a_site_goes_elsewhere(
    scene: Scene, settings: Settings, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, elsewhere = tmp_path / "s.zip", str(tmp_path / "elsewhere")
    assert main(["export", scene.site_id, str(file), "--data-dir", str(settings.data_dir)]) == 0
    exported = re.fullmatch(r"(.+): (\d+) rows and 3 photographs\n", capsys.readouterr().out)
    assert exported is not None and exported[1] == str(file)
    assert main(["migrate", "--data-dir", elsewhere]) == 0
    capsys.readouterr()
    assert main(["import", str(file), "--data-dir", elsewhere]) == 0
    assert capsys.readouterr().out == f"site {scene.site_id}: {exported[2]} rows and 3 photographs\n"
    assert main(["import", str(file), "--data-dir", elsewhere]) == 1
    assert "--as-new" in capsys.readouterr().err
    assert main(["import", str(file), "--as-new", "--json", "--data-dir", elsewhere]) == 0
    assert json.loads(capsys.readouterr().out)["site_id"] != scene.site_id
    there = Settings(data_dir=Path(elsewhere))
    database = Database(there.sqlalchemy_url)
    acts = [row[6:8] for row in rows_of(database)["audit"]]
    assert [action for action, _ in acts] == ["import", "import"]
    database.close()
    assert len(list(open_photo_store(there.photographs_location).photos())) == len(PHOTOS)


@pytest.mark.usefixtures("scene")
def test_the_doctor(settings: Settings, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["doctor", "--data-dir", str(settings.data_dir)]) == 1
    out = capsys.readouterr().out
    assert "BAD  workers: 1 builds wait and no worker runs\n     -> start `scattermark serve`" in out
    assert out.splitlines()[-1] == "not healthy: 1 error, 0 warnings"
    assert main(["doctor", "--json", "--deep", "--data-dir", str(settings.data_dir)]) == 1
    told = json.loads(capsys.readouterr().out)
    assert told["verdict"] == "errors"
    assert {"severity", "check", "what", "advice"} == set(told["findings"][0])
    monkeypatch.setenv("SCATTERMARK_QUEUE_DEPTH", "deep")
    assert main(["doctor", "--data-dir", str(settings.data_dir)]) == 1
    assert "SCATTERMARK_QUEUE_DEPTH='deep'" in capsys.readouterr().err


def test_the_doctor_makes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor", "--data-dir", str(tmp_path / "nothing")]) == 1
    assert main(["doctor", "--data-dir", str(tmp_path)]) == 1
    assert "there is no folder" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
