"""Checks of the keys."""

from __future__ import annotations

from collections.abc import Iterator

from app.services.doctor_findings import Finding, Patient, ok
from app.storage.keys import ApiKey, KeyRepository
from app.storage.paging import every

SOON_S = 14 * 24 * 3600.0  # time to hand out new ones


def check_keys(patient: Patient) -> Iterator[Finding]:
    """Whether those who should get in do, and nobody else."""
    with patient.database.reading() as session:
        keys = [key for key in every(KeyRepository(session).page) if key.revoked_s is None]
    valid = [key for key in keys if key.valid_at(patient.now_s)]
    yield from _expiring(keys, patient.now_s)
    yield from _open_doors(patient)
    if not any("admin" in key.grant.scopes for key in valid) and (keys or _reachable(patient)):
        yield Finding(
            "error" if _reachable(patient) else "warning",
            "keys",
            "no valid key has the scope admin",
            "`scattermark keys create NAME --scope admin`",
        )
    yield ok("keys", f"{len(valid)} valid" if keys else "none: only this machine is let in")


def _expiring(keys: list[ApiKey], now_s: float) -> Iterator[Finding]:
    for key in keys:
        expires_s = key.grant.expires_s
        if expires_s is None or expires_s > now_s + SOON_S:
            continue
        days = abs(expires_s - now_s) / 86400.0
        said = f"expired {days:.0f} days ago" if expires_s <= now_s else f"expires in {days:.0f} days"
        yield Finding("warning", "keys", f"{key.grant.name} {said}", "make a new one, then revoke it")


def _open_doors(patient: Patient) -> Iterator[Finding]:
    if patient.settings.insecure:
        advice = "make keys (`scattermark keys create`), then unset SCATTERMARK_INSECURE"
        yield Finding("warning", "keys", "SCATTERMARK_INSECURE lets everybody in who reaches the service", advice)


def _reachable(patient: Patient) -> bool:
    """Whether the settings are those of a service that other machines call."""
    return patient.settings.require_keys or bool(patient.settings.host_names)
