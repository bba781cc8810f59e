"""A backup restored is the installation it was made of, on either database; what goes wrong changes nothing."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import insert, text

from app.errors import Conflict
from app.services.backup import back_up
from app.services.backup_restore import Target, restore
from app.storage.archive_format import BadArchive, Heading
from app.storage.archive_reader import ArchiveReader
from app.storage.archive_schema import kept_tables, known_revisions, revision_of, tables_at
from app.storage.archive_writer import ArchiveWriter
from app.storage.database import Database
from app.storage.jobs import JobRepository
from app.storage.migrate import up_to_date, upgrade
from app.storage.photo_store import open_photo_store
from app.storage.sites import SiteRepository
from app.storage.target_maps import TargetMapRepository
from app.storage.trajectories import TrajectoryRepository
from tests.databases import Databases
from tests.object_stores import S3Server
from tests.services.backup_scene import CODES, PHOTOS, Scene, fill, rows_of, sha256_of

JOB_COLUMN_STATE = 5


def quiet(_stage: str, _done: int, _total: int) -> None:
    """Nobody listens."""


@pytest.fixture
def scene(sqlite: Databases, tmp_path: Path) -> Iterator[Scene]:
    """What is backed up where the kind of its database makes no difference."""
    database = Database(sqlite.migrated())
    yield fill(database, tmp_path / "photographs")
    database.close()


@pytest.fixture(params=["sqlite", "postgresql"])
def target(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Target]:
    """An installation without tables, on each kind of database."""
    kind: Databases = request.getfixturevalue(request.param)
    url = kind.empty()
    database = Database(url)
    yield Target(database, open_photo_store(str(tmp_path / "restored")))
    database.close()
    kind.take_back(url)


@pytest.fixture
def here(sqlite: Databases, tmp_path: Path) -> Iterator[Target]:
    """One on SQLite, with the newest tables."""
    database = Database(sqlite.migrated())
    yield Target(database, open_photo_store(str(tmp_path / "restored")))
    database.close()


@pytest.fixture
def backup(scene: Scene, tmp_path: Path) -> Path:
    path = tmp_path / "b.zip"
    back_up(scene.database, scene.photos, path, quiet)
    return path


def without_jobs(database: Database) -> dict[str, list[tuple[Any, ...]]]:
    return {name: rows for name, rows in rows_of(database).items() if name != "jobs"}


def test_either_database_into_either(database: Database, target: Target, tmp_path: Path) -> None:
    scene = fill(database, tmp_path / "photographs")
    back_up(database, scene.photos, tmp_path / "b.zip", quiet)
    restore(tmp_path / "b.zip", target, quiet)
    assert without_jobs(target.database) == without_jobs(database)
    assert up_to_date(target.database)
    assert {target.photos.read(sha256_of(data)) for data in PHOTOS.values()} == set(PHOTOS.values())
    with target.database.writing() as session:  # and it can be worked with
        assert {item.code for item in TargetMapRepository(session).load(scene.site_id, 1).targets} == set(CODES)
        assert TrajectoryRepository(session).default(scene.site_id, "phone-1").snapshot_count == 3
        SiteRepository(session).rename(scene.site_id, "elsewhere")
        SiteRepository(session).add("another", "golay", 0.01, None)


def test_a_job_under_way_waits_again_as_a_new_attempt(scene: Scene, backup: Path, here: Target) -> None:
    restore(backup, here, quiet)  # tables that are there and empty are no hindrance
    assert without_jobs(here.database) == without_jobs(scene.database)
    with here.database.reading() as session:
        job = JobRepository(session).get(scene.job_id)
    ended = [row for row in rows_of(here.database)["jobs"] if row[JOB_COLUMN_STATE] == "succeeded"]
    assert (job.state, job.owner, job.done, job.total, job.attempt) == ("queued", None, 0, 0, 2)
    assert len(ended) == 1 and ended[0] in rows_of(scene.database)["jobs"]


def test_a_database_with_rows_is_replaced_only_when_told(scene: Scene, backup: Path, target: Target) -> None:
    upgrade(target.database)
    with target.database.writing() as session:
        SiteRepository(session).add("precious", "golay", 0.01, None)
        session.execute(text("CREATE TABLE of_others (x INTEGER)"))
    before = rows_of(target.database)
    target.database.close()
    with pytest.raises(Conflict, match="--force"):
        restore(backup, target, quiet)
    assert rows_of(target.database) == before
    target.database.close()
    restore(backup, Target(target.database, target.photos, replace=True), quiet)
    assert without_jobs(target.database) == without_jobs(scene.database)
    with target.database.reading() as session:
        assert session.execute(text("SELECT count(*) FROM of_others")).scalar_one() == 0


def test_a_database_in_use_is_left_alone(backup: Path, target: Target) -> None:
    upgrade(target.database)
    target.database.close()
    service = Database(target.database.url)
    service.ping()
    try:
        with pytest.raises(Conflict, match="stop the service"):
            restore(backup, Target(target.database, target.photos, replace=True), quiet)
    finally:
        service.close()
    restore(backup, target, quiet)


def test_a_photograph_that_was_lost_before_is_no_hindrance(scene: Scene, tmp_path: Path, here: Target) -> None:
    lost = sha256_of(PHOTOS["IMG_0.jpg"])
    scene.photos.delete(lost)
    back_up(scene.database, scene.photos, tmp_path / "b.zip", quiet)
    assert restore(tmp_path / "b.zip", here, quiet).photographs.missing == (lost,)
    assert not here.photos.holds(lost)


@pytest.mark.parametrize("stage", ["check", "photographs", "rows"])
def test_an_interruption_leaves_the_target_as_it_was(backup: Path, here: Target, stage: str) -> None:
    with here.database.writing() as session:
        SiteRepository(session).add("precious", "golay", 0.01, None)
    before = rows_of(here.database)
    here.database.close()
    kept = sha256_of(PHOTOS["IMG_2.jpg"])
    here.photos.put(kept, PHOTOS["IMG_2.jpg"])

    def interrupt(at: str, done: int, total: int) -> None:
        if at == stage and done == total:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        restore(backup, Target(here.database, here.photos, replace=True), interrupt)
    assert rows_of(here.database) == before
    assert [item.name for item in here.photos.photos()] == [kept]


KILLED = """
import os, signal, sys
from dataclasses import replace
from pathlib import Path
from app.services.backup_restore import Target, restore
from app.storage.database import Database
from app.storage.photo_store import open_photo_store

def report(stage, done, total):
    if stage == "rows" and done == total:
        os.kill(os.getpid(), signal.SIGKILL)

restore(Path(sys.argv[1]), Target(Database(sys.argv[2]), open_photo_store(sys.argv[3]), replace=True), report)
"""


def test_a_killed_restore_changed_nothing_and_can_be_repeated(
    scene: Scene, backup: Path, target: Target, tmp_path: Path
) -> None:
    upgrade(target.database)
    with target.database.writing() as session:
        SiteRepository(session).add("precious", "golay", 0.01, None)
    before = rows_of(target.database)
    target.database.close()
    killed = subprocess.run(
        [sys.executable, "-c", KILLED, str(backup), target.database.url, str(tmp_path / "restored")], check=False
    )
    assert killed.returncode < 0
    assert rows_of(target.database) == before
    target.database.close()
    restore(backup, Target(target.database, target.photos, replace=True), quiet)
    assert without_jobs(target.database) == without_jobs(scene.database)


def changed(backup: Path, change: Callable[[str, list[bytes]], list[bytes]], **heading: Any) -> Path:
    """The backup with other rows, and digests that fit them."""
    path = backup.with_name("changed.zip")
    with backup.open("rb") as file, ArchiveReader(file) as reader, path.open("wb") as out, ArchiveWriter(out) as writer:
        for table in reader.manifest.tables:
            lines = list(reader.lines(table.name)) if table.rows else []
            writer.add_table(table.name, table.columns, change(table.name, lines))
        for sha256 in reader.photos:
            writer.add_photo(sha256, reader.photo(sha256))
        told = reader.manifest.heading
        values = {"kind": told.kind, "revision": told.revision, "app_version": "9.9", "created_s": told.created_s}
        writer.finish(Heading(**{**values, **heading}), with_photographs=True)
    return path


def twice(name: str) -> Callable[[str, list[bytes]], list[bytes]]:
    return lambda table, lines: lines * 2 if table == name else lines


def dropped(name: str) -> Callable[[str, list[bytes]], list[bytes]]:
    return lambda table, lines: [] if table == name else lines


def as_it_is(_table: str, lines: list[bytes]) -> list[bytes]:
    return lines


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (twice("mapped_targets"), "mapped_targets cannot take"),
        (dropped("trajectories"), "belongs to"),
        (lambda _, lines: [b"[1,2]\n" for _ in lines], "cannot take"),
    ],
)
def test_rows_that_contradict_each_other(
    backup: Path, here: Target, change: Callable[[str, list[bytes]], list[bytes]], words: str
) -> None:
    with pytest.raises(BadArchive, match=words):
        restore(changed(backup, change), here, quiet)
    assert not any(rows_of(here.database).values())
    assert list(here.photos.photos()) == []


def test_postgres_finds_a_reference_to_nothing_as_well(backup: Path, postgresql: Databases, tmp_path: Path) -> None:
    url = postgresql.empty()
    receiver = Database(url)
    target = Target(receiver, open_photo_store(str(tmp_path / "restored")))
    with pytest.raises(BadArchive, match="cannot take"):
        restore(changed(backup, dropped("trajectories")), target, quiet)
    with receiver.reading() as session:
        assert revision_of(session.connection()) is None
    receiver.close()
    postgresql.take_back(url)


def test_a_backup_of_a_later_release(backup: Path, here: Target) -> None:
    with pytest.raises(BadArchive, match=r"revision '9999', made by Scattermark '9\.9'"):
        restore(changed(backup, as_it_is, revision="9999"), here, quiet)


def test_one_site_is_no_backup(backup: Path, here: Target) -> None:
    with pytest.raises(BadArchive, match="scattermark import"):
        restore(changed(backup, as_it_is, kind="site"), here, quiet)


def test_tables_of_another_revision(backup: Path, here: Target) -> None:
    with pytest.raises(BadArchive, match="not those of its revision 0001"):
        restore(changed(backup, as_it_is, revision="0001"), here, quiet)


def test_what_is_no_archive(tmp_path: Path, here: Target) -> None:
    (tmp_path / "b.zip").write_bytes(b"a letter to somebody")
    with pytest.raises(BadArchive):
        restore(tmp_path / "b.zip", here, quiet)
    with zipfile.ZipFile(tmp_path / "b.zip", "w") as archive:
        archive.writestr("letter.txt", "a letter to somebody")
    with pytest.raises(BadArchive):
        restore(tmp_path / "b.zip", here, quiet)


# Rows of the first tables, by column; what is not named is null.
OF_0001: dict[str, list[dict[str, Any]]] = {
    "sites": [
        {"id": "s", "name": "room", "code_family": "golay", "plate_u_m": 0.014, "last_version": 0, "created_s": 1.0}
    ],
    "surveys": [{"id": "v", "site_id": "s", "note": "", "created_s": 1.0}],
    "jobs": [
        {"id": "j", "kind": "build", "site_id": "s", "survey_id": "v", "options": {}, "created_s": 1.0}
        | {"state": "running", "stage": "detect", "done": 1, "total": 2, "owner": "somebody"}
    ],
    "trajectories": [{"id": "t", "site_id": "s", "name": "walk", "created_s": 1.0}],
    "snapshots": [
        {"id": f"p{number}", "site_id": "s", "trajectory_id": "t", "map_version": 1, "captured_s": float(number)}
        | {"received_s": 9.0, "time_source": "client", "reason": "no-targets", "seen": {"targets": []}}
        for number in range(3)
    ],
}
COUNTS = {"snapshot_count": 3, "failures": {"no-targets": 3}, "first_s": 0.0, "last_s": 2.0}


@pytest.mark.parametrize(("revision", "kind"), [("0001", "sqlite"), ("0003", "sqlite"), ("0003", "postgresql")])
def test_an_older_database_is_brought_up_to_date(
    request: pytest.FixtureRequest, sqlite: Databases, tmp_path: Path, revision: str, kind: str
) -> None:
    receiving: Databases = request.getfixturevalue(kind)
    target = Target(Database(receiving.empty()), open_photo_store(str(tmp_path / "restored")))
    source = Database(sqlite.empty())
    upgrade(source, revision)
    with source.writing() as session:
        for table in kept_tables(tables_at(revision)):
            for ordinal, row in enumerate(OF_0001.get(table.name, []), start=1):
                since = {"ordinal": ordinal, **(COUNTS if table.name == "trajectories" else {})}
                added = {name: value for name, value in since.items() if name in table.columns}
                session.execute(insert(table).values(row | added))
    assert back_up(source, None, tmp_path / "old.zip", quiet).manifest.heading.revision == revision
    source.close()
    restore(tmp_path / "old.zip", target, quiet)
    assert up_to_date(target.database)
    with target.database.reading() as session:
        walk = TrajectoryRepository(session).get("t")
        assert (walk.snapshot_count, walk.failures, walk.first_s, walk.last_s) == (3, (("no-targets", 3),), 0.0, 2.0)
        job = JobRepository(session).get("j")
        assert (job.state, job.owner, job.attempt) == ("queued", None, 2)
    target.database.close()
    receiving.take_back(target.database.url)


def test_a_text_that_only_sqlite_takes_is_named(sqlite: Databases, postgresql: Databases, tmp_path: Path) -> None:
    source, url = Database(sqlite.migrated()), postgresql.empty()
    receiver = Database(url)
    with source.writing() as session:
        SiteRepository(session).add("x" * 300, "golay", 0.01, None)
    back_up(source, None, tmp_path / "b.zip", quiet)
    with pytest.raises(BadArchive, match="table sites cannot take"):
        restore(tmp_path / "b.zip", Target(receiver, open_photo_store(str(tmp_path / "restored"))), quiet)
    source.close()
    receiver.close()
    postgresql.take_back(url)


def test_the_newest_revision_is_the_one_that_is_written(scene: Scene, backup: Path) -> None:
    with backup.open("rb") as file, ArchiveReader(file) as reader:
        assert reader.manifest.heading.revision == known_revisions()[0]
    assert scene.site_id


def test_from_a_folder_into_an_object_store_and_back(
    scene: Scene, backup: Path, here: Target, s3: S3Server, sqlite: Databases, tmp_path: Path
) -> None:
    remote = replace(here, photos=open_photo_store(s3.new_url()))
    restore(backup, remote, quiet)
    assert back_up(remote.database, remote.photos, tmp_path / "remote.zip", quiet).lost == ()
    back = Target(Database(sqlite.empty()), open_photo_store(str(tmp_path / "back")))
    restore(tmp_path / "remote.zip", back, quiet)
    assert without_jobs(back.database) == without_jobs(scene.database)
    assert {back.photos.read(item.name) for item in back.photos.photos()} == set(PHOTOS.values())
    back.database.close()
