"""Checks of the database: its tables, its file, its clock, and the workers that have signed on."""

from __future__ import annotations

from collections.abc import Iterator

from app.services.doctor_findings import Finding, Patient, ok
from app.storage.archive_schema import known_revisions, revision_of
from app.storage.inspection import clock_s, file_faults, journal_mode, latest_rows, lost_references
from app.storage.jobs import JobRepository
from app.storage.workers import WorkerRepository

CLOCK_TOLERANCE_S = 5.0  # between two machines that keep time by the network: far below a second
FUTURE_TOLERANCE_S = 60.0


def check_tables(patient: Patient) -> Iterator[Finding]:
    """Whether the database answers, and which tables it has."""
    with patient.database.reading() as session:
        revision = revision_of(session.connection())
    newest = known_revisions()[0]
    if revision == newest:
        yield ok("tables", f"revision {revision}")
    elif revision is None:
        yield Finding(
            "error",
            "tables",
            "the database has no tables",
            "check SCATTERMARK_DATABASE_URL and --data-dir; `scattermark migrate` makes them in a new database",
        )
    elif revision in known_revisions():
        yield Finding(
            "error",
            "tables",
            f"they are of revision {revision}, this release works with {newest}",
            "back up, then `scattermark migrate`",
        )
    else:
        yield Finding(
            "error", "tables", f"they are of revision {revision}, of a later release", "install that release again"
        )


def check_file(patient: Patient) -> Iterator[Finding]:
    """What SQLite finds in its file; Postgres looks after its own."""
    with patient.database.reading() as session:
        faults = file_faults(session, deep=patient.deep)
        lost = lost_references(session)
        mode = journal_mode(session)
    if faults:
        advice = "stop the service, keep a copy of the file, and restore the last backup"
        yield Finding("error", "database file", f"damaged: {'; '.join(faults)}", advice)
    if lost:
        advice = "another program has changed the file: restore the last backup"
        yield Finding("error", "database file", f"rows refer to rows that are gone: {', '.join(lost)}", advice)
    if mode not in (None, "wal"):
        advice = "readers and writers hinder each other: move the data folder to a local disk, where WAL works"
        yield Finding("warning", "database file", f"its journal mode is {mode}", advice)
    if not faults and not lost and mode in (None, "wal"):
        yield ok("database file", "whole" if mode else "Postgres")


def check_clock(patient: Patient) -> Iterator[Finding]:
    """Whether this machine, the database and its rows agree about the time."""
    with patient.database.reading() as session:
        now_s = patient.now_s
        behind_s = now_s - clock_s(session)
        future = [row for row in latest_rows(session) if row.latest_s > now_s + FUTURE_TOLERANCE_S]
    advice = "let the clocks be set by the network (NTP); times of snapshots depend on them"
    if abs(behind_s) > CLOCK_TOLERANCE_S:
        yield Finding("error", "clock", f"this machine and the database differ by {abs(behind_s):.0f} s", advice)
    for row in future:
        ahead_s = row.latest_s - now_s
        yield Finding("warning", "clock", f"{row.table} has rows written {ahead_s:.0f} s in the future", advice)
    if abs(behind_s) <= CLOCK_TOLERANCE_S and not future:
        yield ok("clock", "no row comes from the future")


def check_workers(patient: Patient) -> Iterator[Finding]:
    """Whether somebody does the builds that wait."""
    with patient.database.reading() as session:
        workers = WorkerRepository(session).workers()
        waiting = len(JobRepository(session).open_jobs())
    live = [worker for worker in workers if worker.live]
    silent = [worker for worker in workers if not worker.live and not worker.left]
    if silent:
        names = ", ".join(worker.name for worker in silent)
        advice = "start them again if they should run; their builds go on elsewhere" if live else _START
        yield Finding("warning", "workers", f"died without a word: {names}", advice)
    if waiting and not live:
        yield Finding("error", "workers", f"{waiting} builds wait and no worker runs", _START)
    if live or not (waiting or silent):
        yield ok("workers", f"{len(live)} run, {waiting} builds wait or run")


_START = "start `scattermark serve` or `scattermark worker`"
