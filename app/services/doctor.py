"""Look an installation over and say what to do about what is wrong with it. Nothing is changed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from sqlalchemy.exc import DatabaseError

from app.errors import ScattermarkError
from app.services.doctor_access import check_keys
from app.services.doctor_database import check_clock, check_file, check_tables, check_workers
from app.services.doctor_findings import Finding, Patient
from app.services.doctor_machine import check_folder, check_leftovers, check_variables, check_versions
from app.services.doctor_photographs import check_photographs, check_room, check_store

Check = Callable[[Patient], Iterator[Finding]]
Verdict = Literal["healthy", "warnings", "errors"]

FIRST: tuple[tuple[str, Check], ...] = (
    ("settings", check_variables),
    ("versions", check_versions),
    ("data folder", check_folder),
    ("photo store", check_store),
    ("tables", check_tables),
)
# These read rows, which needs the tables of this release.
THEN: tuple[tuple[str, Check], ...] = (
    ("database file", check_file),
    ("clock", check_clock),
    ("workers", check_workers),
    ("keys", check_keys),
    ("room", check_room),
    ("photographs", check_photographs),
    ("leftovers", check_leftovers),
)


@dataclass(frozen=True)
class Examination:
    """What was found."""

    findings: tuple[Finding, ...]

    @property
    def verdict(self) -> Verdict:
        """The worst of it."""
        severities = {finding.severity for finding in self.findings}
        if "error" in severities:
            return "errors"
        return "warnings" if "warning" in severities else "healthy"

    @property
    def sentence(self) -> str:
        """The verdict in one line."""
        errors, warnings = (
            sum(finding.severity == severity for finding in self.findings) for severity in ("error", "warning")
        )
        if errors:
            return f"not healthy: {_counted(errors, 'error')}, {_counted(warnings, 'warning')}"
        return f"healthy, with {_counted(warnings, 'warning')}" if warnings else "healthy"


def examine(patient: Patient) -> Examination:
    """Run all checks; when the tables are wrong, those that need none."""
    findings = _run(FIRST, patient)
    blocked = any(finding.severity == "error" and finding.check == "tables" for finding in findings)
    if not blocked:
        findings += _run(THEN, patient)
    return Examination(tuple(findings))


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _run(checks: tuple[tuple[str, Check], ...], patient: Patient) -> list[Finding]:
    findings: list[Finding] = []
    for name, check in checks:
        try:
            findings += check(patient)
        except ScattermarkError as error:
            findings.append(Finding("error", name, "gave no answer", error.detail))
        except DatabaseError as error:
            advice = "stop the service, keep a copy of the database, and restore the last backup"
            findings.append(Finding("error", name, f"the database cannot be read ({error.orig})", advice))
        except OSError as error:
            findings.append(Finding("error", name, str(error), "see that the service's user may read and write there"))
    return findings
