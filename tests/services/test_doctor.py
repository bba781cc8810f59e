"""Each thing that the doctor finds is brought about for real, found, and nothing is changed by looking."""

from __future__ import annotations

import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import make_url, text, update

from app.services.doctor import Examination, examine
from app.services.doctor_database import check_file
from app.services.doctor_findings import Finding, Patient
from app.services.doctor_photographs import SAMPLE
from app.settings import Settings
from app.storage.database import Database
from app.storage.jobs import JobRepository
from app.storage.keys import Fingerprint, KeyRepository, NewKey
from app.storage.migrate import upgrade
from app.storage.models import JobRow, SiteRow, WorkerRow
from app.storage.photo_store import open_photo_store
from app.storage.workers import WorkerRepository
from tests.databases import Databases
from tests.services.backup_scene import PHOTOS, fill, jpeg, rows_of, sha256_of

NOW_S = time.time()


@pytest.fixture
def patient(database: Database, tmp_path: Path) -> Patient:
    return healthy(database, tmp_path / "data")


@pytest.fixture
def here(sqlite: Databases, tmp_path: Path) -> Iterator[Patient]:
    """Where the kind of database makes no difference."""
    database = Database(sqlite.migrated())
    yield healthy(database, tmp_path / "here")
    database.close()


def healthy(database: Database, folder: Path) -> Patient:
    """An installation in which all is well."""
    folder.mkdir(mode=0o700)
    settings = Settings(data_dir=folder, database_url=database.url, min_free_bytes=0)
    scene = fill(database, settings.photographs_dir)
    with database.writing() as session:
        session.execute(update(JobRow).where(JobRow.id == scene.job_id).values(state="succeeded"))
    return Patient(settings, database, scene.photos, ())


def wrong(patient: Patient) -> list[Finding]:
    return [finding for finding in examine(patient).findings if finding.severity != "ok"]


def only(patient: Patient, severity: str, check: str, words: str) -> None:
    """This is what is found, and nothing else; it says what to do."""
    (finding,) = wrong(patient)
    assert (finding.severity, finding.check) == (severity, check)
    assert words in finding.what
    assert len(finding.advice) > 5


def with_settings(patient: Patient, **values: Any) -> Patient:
    return replace(patient, settings=replace(patient.settings, **values))


def test_a_healthy_installation(patient: Patient) -> None:
    before = rows_of(patient.database)
    found = examine(patient)
    assert wrong(patient) == []
    assert (found.verdict, found.sentence) == ("healthy", "healthy")
    checks = {finding.check for finding in found.findings}
    assert {"settings", "versions", "tables", "database file", "clock", "workers", "keys", "photographs"} <= checks
    assert examine(replace(patient, deep=True)).verdict == "healthy"
    assert rows_of(patient.database) == before


def test_the_verdict_is_the_worst() -> None:
    warning, error = Finding("warning", "a", "b", "c"), Finding("error", "a", "b", "c")
    assert Examination((warning,)).sentence == "healthy, with 1 warning"
    assert Examination((warning, error, error)).sentence == "not healthy: 2 errors, 1 warning"
    assert Examination((warning, error)).verdict == "errors"


def test_a_variable_that_nothing_reads(here: Patient) -> None:
    only(replace(here, variables=("SCATTERMARK_DATADIR",)), "warning", "settings", "SCATTERMARK_DATADIR")


def test_a_database_that_others_can_read(here: Patient) -> None:
    folder = here.settings.data_dir
    (folder / "scattermark.db").touch(mode=0o644)
    folder.chmod(0o755)
    only(here, "warning", "data folder", "scattermark.db")


def test_no_tables_and_old_ones_and_those_of_a_later_release(empty_database: Database, patient: Patient) -> None:
    sick = replace(patient, database=empty_database)
    only(sick, "error", "tables", "no tables")
    upgrade(empty_database, "0003")
    only(sick, "error", "tables", "revision 0003")
    with empty_database.writing() as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    only(sick, "error", "tables", "later release")


def test_a_database_that_cannot_be_reached(here: Patient) -> None:
    gone = Database("postgresql://nobody@127.0.0.1:1/nothing?connect_timeout=1")
    found = [finding for finding in wrong(replace(here, database=gone)) if finding.check == "tables"]
    assert [finding.severity for finding in found] == ["error"]
    gone.close()


def test_a_damaged_file(here: Patient) -> None:
    path = Path(str(make_url(here.database.url).database))
    here.database.close()  # the last to leave writes the log into the file
    with closing(sqlite3.connect(path)) as connection:
        (root,) = connection.execute("SELECT rootpage FROM sqlite_master WHERE name = 'snapshots'").fetchone()
        (size,) = connection.execute("PRAGMA page_size").fetchone()
    with path.open("r+b") as file:
        file.seek((root - 1) * size)
        file.write(b"\xff" * size)
    found = wrong(replace(here, deep=True))
    assert any(finding.severity == "error" and finding.check == "database file" for finding in found)


def test_rows_that_refer_to_nothing(here: Patient) -> None:
    with closing(sqlite3.connect(str(make_url(here.database.url).database))) as connection, connection:
        connection.execute("DELETE FROM target_maps")  # without the rows that belong to it, as foreign keys are off
    only(here, "error", "database file", "mapped_targets -> target_maps")


def test_a_file_without_a_log(here: Patient) -> None:
    """As on a network disk; a database in memory has none either."""
    inside = Database("sqlite://")
    (finding,) = check_file(replace(here, database=inside))
    assert (finding.severity, "memory" in finding.what) == ("warning", True)
    inside.close()


def test_rows_of_the_future_and_a_clock_that_is_wrong(patient: Patient) -> None:
    with patient.database.writing() as session:
        session.execute(update(SiteRow).values(created_s=NOW_S + 7200.0))
    only(patient, "warning", "clock", "sites has rows written")
    late = replace(patient, clock=lambda: time.time() - 3600.0)
    assert any(finding.severity == "error" and "differ by" in finding.what for finding in wrong(late))


@pytest.fixture
def silent_worker(patient: Patient) -> str:
    with patient.database.writing() as session:
        worker_id = WorkerRepository(session).add("host/1", "slot-1")
        session.execute(update(WorkerRow).values(beat_s=NOW_S - 600.0))
    return worker_id


def test_a_worker_that_died(patient: Patient, silent_worker: str) -> None:
    only(patient, "warning", "workers", "host/1")
    with patient.database.writing() as session:
        WorkerRepository(session).leave(silent_worker)
    assert wrong(patient) == []


def test_builds_that_nobody_does(here: Patient) -> None:
    with here.database.writing() as session:
        row = session.query(JobRow).first()
        assert row is not None
        JobRepository(session).add("build", row.site_id, row.survey_id, {})
    only(here, "error", "workers", "1 builds wait")
    with here.database.writing() as session:
        WorkerRepository(session).add("host/1", "slot-1")
    assert wrong(here) == []


def new_key(patient: Patient, name: str, scope: str, expires_s: float | None = None) -> str:
    with patient.database.writing() as session:
        wanted = NewKey(name, (scope,), expires_s=expires_s)
        return KeyRepository(session).add(wanted, Fingerprint(sha256_of(name.encode()), "sm")).key_id


def test_keys_that_expire_and_nobody_who_may_make_others(here: Patient) -> None:
    new_key(here, "chief", "admin")
    new_key(here, "phones", "locate", NOW_S - 3 * 86400.0)
    only(here, "warning", "keys", "phones expired 3 days ago")
    new_key(here, "tablets", "locate", NOW_S + 3.4 * 86400.0)
    assert [finding.what for finding in wrong(here)] == ["phones expired 3 days ago", "tablets expires in 3 days"]


def test_no_administrator(here: Patient) -> None:
    only(with_settings(here, allowed_hosts="scatter.example"), "error", "keys", "no valid key has the scope admin")
    only(with_settings(here, require_keys=True), "error", "keys", "no valid key has the scope admin")
    new_key(here, "phones", "locate")
    only(here, "warning", "keys", "no valid key has the scope admin")
    chief = new_key(here, "chief", "admin")
    assert wrong(here) == []
    with here.database.writing() as session:
        KeyRepository(session).revoke(chief)
    only(here, "warning", "keys", "no valid key has the scope admin")


def test_a_service_that_lets_everybody_in(here: Patient) -> None:
    only(with_settings(here, insecure=True), "warning", "keys", "SCATTERMARK_INSECURE")


def test_a_full_disk_and_a_full_quota(here: Patient) -> None:
    only(with_settings(here, min_free_bytes=2**60), "error", "room", "uploads are refused")
    used = sum(12345 for _ in PHOTOS)  # as the scene's rows say
    only(with_settings(here, quota_bytes=used + 10), "warning", "room", "of the quota")
    only(with_settings(here, quota_bytes=used), "error", "room", "of the quota")


def test_lost_photographs(here: Patient) -> None:
    lost = sha256_of(PHOTOS["IMG_1.jpg"])
    here.photos.delete(lost)
    only(here, "error", "photographs", f"1 of 3 are lost: {lost}")


def test_altered_photographs(here: Patient) -> None:
    altered = sha256_of(PHOTOS["IMG_1.jpg"])
    here.photos.delete(altered)
    here.photos.put(altered, b"other bytes")
    only(here, "error", "photographs", altered)  # all three are in the sample
    only(replace(here, deep=True), "error", "photographs", altered)
    assert len(PHOTOS) < SAMPLE


def test_what_was_left_behind(here: Patient) -> None:
    orphan = jpeg(99)
    here.photos.put(sha256_of(orphan), orphan)
    old = here.settings.data_dir / "import-killed"
    old.mkdir()
    os.utime(old, (NOW_S - 2 * 86400.0,) * 2)
    later = replace(here, clock=lambda: time.time() + 7200.0)
    found = {finding.what for finding in wrong(later) if finding.check == "leftovers"}
    assert any("1 photographs that nothing refers to" in what for what in found)
    assert any("import-killed" in what for what in found)


def test_a_store_that_cannot_be_written(here: Patient) -> None:
    here.photos.check()
    folder = here.settings.photographs_dir
    gone = open_photo_store(str(folder / "elsewhere"))
    for path in (folder / "elsewhere").rglob("*"):
        path.rmdir()
    (folder / "elsewhere").rmdir()
    found = [finding for finding in wrong(replace(here, photos=gone)) if finding.check == "photo store"]
    assert [finding.severity for finding in found] == ["error"]
