"""A backup is one moment of the database, whole or not there at all, whatever goes on beside it."""

from __future__ import annotations

import stat
import threading
import zipfile
from pathlib import Path

import pytest
from sqlalchemy import text

from app.services.backup import back_up
from app.storage.archive_reader import ArchiveReader
from app.storage.archive_schema import TRANSIENT
from app.storage.database import Database
from app.storage.migrate import WrongTables
from app.storage.models import Base
from app.storage.sites import SiteRepository
from app.storage.surveys import SurveyRepository
from tests.services.backup_scene import PHOTOS, Scene, fill, rows_of, sha256_of
from tests.storage.walks import Step, add_walk

WALK = [Step(float(number), (0.0, 0.0, 1.0)) for number in range(1200)]  # more than one batch


@pytest.fixture
def scene(database: Database, tmp_path: Path) -> Scene:
    return fill(database, tmp_path / "photographs")


def quiet(_stage: str, _done: int, _total: int) -> None:
    """Nobody listens."""


def test_a_backup_holds_every_table_and_photograph(scene: Scene, tmp_path: Path) -> None:
    told: list[tuple[str, int, int]] = []
    backup = back_up(scene.database, scene.photos, tmp_path / "b.zip", lambda *step: told.append(step))
    assert backup.lost == ()
    expected = {name: len(rows) for name, rows in rows_of(scene.database).items()}
    assert {table.name: table.rows for table in backup.manifest.tables} == expected
    assert set(expected) == set(Base.metadata.tables) - TRANSIENT
    assert backup.manifest.photographs.count == len(PHOTOS)
    assert ("rows", sum(expected.values()), sum(expected.values())) in told
    assert told[-1] == ("photographs", 3, 3)
    with (tmp_path / "b.zip").open("rb") as file, ArchiveReader(file) as reader:
        reader.verify(quiet)
        assert {reader.photo(sha256) for sha256 in reader.photos} == set(PHOTOS.values())


def test_only_its_owner_can_read_it(scene: Scene, tmp_path: Path) -> None:
    back_up(scene.database, scene.photos, tmp_path / "b.zip", quiet)
    assert stat.S_IMODE((tmp_path / "b.zip").stat().st_mode) == 0o600


def test_without_photographs(scene: Scene, tmp_path: Path) -> None:
    manifest = back_up(scene.database, None, tmp_path / "b.zip", quiet).manifest
    assert (manifest.photographs.included, manifest.photographs.count) == (False, 0)


def test_what_is_written_meanwhile_is_not_in_it(scene: Scene, tmp_path: Path) -> None:
    """A site that appears after the first table was read is in none of the later ones."""
    before = rows_of(scene.database)
    added: list[threading.Thread] = []

    def add_once(stage: str, _done: int, _total: int) -> None:
        if stage == "rows" and not added:
            added.append(threading.Thread(target=add_site))
            added[0].start()
            added[0].join()

    def add_site() -> None:
        with scene.database.writing() as session:
            site_id = SiteRepository(session).add("late", "golay", 0.01, None).site_id
            SurveyRepository(session).add(site_id, "late", None)

    manifest = back_up(scene.database, scene.photos, tmp_path / "b.zip", add_once).manifest
    assert {table.name: table.rows for table in manifest.tables} == {name: len(rows) for name, rows in before.items()}
    assert len(rows_of(scene.database)["surveys"]) == len(before["surveys"]) + 1


def test_many_rows_come_in_batches(scene: Scene, tmp_path: Path) -> None:
    add_walk(scene.database, scene.site_id, WALK)
    manifest = back_up(scene.database, None, tmp_path / "b.zip", quiet).manifest
    rows = {table.name: table.rows for table in manifest.tables}
    assert rows["snapshots"] == len(WALK) + 3


@pytest.mark.parametrize("damage", ["lost", "altered"])
def test_a_photograph_that_the_store_has_lost_is_named(scene: Scene, tmp_path: Path, damage: str) -> None:
    sha256 = sha256_of(PHOTOS["IMG_1.jpg"])
    scene.photos.delete(sha256)
    if damage == "altered":
        scene.photos.put(sha256, b"other bytes")
    backup = back_up(scene.database, scene.photos, tmp_path / "b.zip", quiet)
    assert backup.lost == backup.manifest.photographs.missing == (sha256,)
    assert backup.manifest.photographs.count == len(PHOTOS) - 1


def test_a_photograph_that_was_removed_meanwhile_is_not_lost(scene: Scene, tmp_path: Path) -> None:
    def remove(stage: str, done: int, _total: int) -> None:
        if (stage, done) == ("photographs", 0):
            with scene.database.writing() as session:
                session.execute(text("DELETE FROM photographs"))
            for data in PHOTOS.values():
                scene.photos.delete(sha256_of(data))

    backup = back_up(scene.database, scene.photos, tmp_path / "b.zip", remove)
    assert backup.lost == ()
    assert len(backup.manifest.photographs.missing) == len(PHOTOS)


def test_a_backup_that_breaks_off_leaves_the_one_before(scene: Scene, tmp_path: Path) -> None:
    folder = tmp_path / "backups"
    folder.mkdir()
    back_up(scene.database, scene.photos, folder / "b.zip", quiet)
    before = (folder / "b.zip").read_bytes()

    def break_off(stage: str, done: int, _total: int) -> None:
        if (stage, done) == ("photographs", 2):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        back_up(scene.database, scene.photos, folder / "b.zip", break_off)
    assert [path.name for path in folder.iterdir()] == ["b.zip"]
    assert (folder / "b.zip").read_bytes() == before
    back_up(scene.database, None, folder / "b.zip", quiet)
    with zipfile.ZipFile(folder / "b.zip") as archive:
        assert not any(name.startswith("photographs/") for name in archive.namelist())


def test_a_database_without_tables(empty_database: Database, tmp_path: Path) -> None:
    with pytest.raises(WrongTables, match="no tables"):
        back_up(empty_database, None, tmp_path / "b.zip", quiet)
    assert not (tmp_path / "b.zip").exists()
