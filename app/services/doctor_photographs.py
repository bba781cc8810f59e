"""Checks of the photographs: the store answers, has room, and holds unaltered what rows name."""

from __future__ import annotations

import random
from collections.abc import Iterator

from app.services.backup_parts import unaltered
from app.services.doctor_findings import Finding, Patient, ok
from app.storage.archive_schema import current_revision, tables_at
from app.storage.backup_rows import photos_of
from app.storage.photo_references import used_bytes

SAMPLE = 32  # photographs read without --deep: some seconds on any store
NEARLY_FULL = 0.9  # of the quota
MEGABYTE = 1e6
SHOWN = 5
RESTORE = "restore them from a backup or upload them again"


def check_store(patient: Patient) -> Iterator[Finding]:
    """Whether photographs can be kept now."""
    patient.photos.check()
    yield ok("photo store", "a folder of this machine" if patient.photos.local else "an object store, which answers")


def check_room(patient: Patient) -> Iterator[Finding]:
    """Disk and quota."""
    settings, free = patient.settings, patient.photos.free_bytes()
    with patient.database.reading() as session:
        used = used_bytes(session)
    if free < settings.min_free_bytes:
        yield Finding(
            "error",
            "room",
            f"{free / MEGABYTE:.0f} MB are free, fewer than SCATTERMARK_MIN_FREE_BYTES: uploads are refused",
            "make room on the disk; `scattermark purge` removes what nothing refers to",
        )
    if settings.quota_bytes and used > NEARLY_FULL * settings.quota_bytes:
        yield Finding(
            "error" if used >= settings.quota_bytes else "warning",
            "room",
            f"photographs take {used / MEGABYTE:.0f} of {settings.quota_bytes / MEGABYTE:.0f} MB of the quota",
            "raise SCATTERMARK_QUOTA_BYTES, or remove sites or kept snapshots",
        )
    yield ok("room", f"photographs take {used / MEGABYTE:.0f} MB, {free / MEGABYTE:.0f} MB are free")


def check_photographs(patient: Patient) -> Iterator[Finding]:
    """Whether the store holds what rows name, and some of it (all, when deep) unaltered."""
    with patient.database.reading() as session:
        connection = session.connection()
        named = photos_of(connection, tables_at(current_revision(connection)))
    held = {item.name for item in patient.photos.photos()}
    lost = [sha256 for sha256 in named if sha256 not in held]
    there = [sha256 for sha256 in named if sha256 in held]
    read = there if patient.deep else random.sample(there, min(SAMPLE, len(there)))
    altered = [sha256 for sha256 in read if unaltered(patient.photos, sha256) is None]
    if lost:
        yield Finding("error", "photographs", f"{len(lost)} of {len(named)} are lost: {_some(lost)}", RESTORE)
    if altered:
        found = f"{len(altered)} of {len(read)} that were read are altered: {_some(altered)}"
        yield Finding("error", "photographs", found, RESTORE)
    if not lost and not altered:
        hint = "" if patient.deep or len(read) == len(there) else "; --deep reads all"
        yield ok("photographs", f"{len(named)} named and held, {len(read)} read{hint}")


def _some(digests: list[str]) -> str:
    return ", ".join(digests[:SHOWN]) + (" ..." if len(digests) > SHOWN else "")
