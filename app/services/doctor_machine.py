"""Checks of the machine: settings, versions, the data folder and what was left in it."""

from __future__ import annotations

import platform
import re
import stat
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import fields
from importlib.metadata import PackageNotFoundError, requires, version

from app.services.doctor_findings import Finding, Patient, ok
from app.services.housekeeping import look_around
from app.settings import PREFIX, Settings

OLDEST_PYTHON = (3, 11)
ABANDONED_AFTER_S = 24 * 3600.0  # no backup or import lasts a day
LEFTOVERS = ("import-*", ".*.zip.*")
SHOWN = ("numpy", "opencv-python-headless", "sqlalchemy", "fastapi", "dbos")
MEGABYTE = 1e6


def check_variables(patient: Patient) -> Iterator[Finding]:
    """Settings were read when this is asked; a name that nothing reads is a slip of the pen."""
    known = {PREFIX + entry.name.upper() for entry in fields(Settings)}
    unknown = sorted(set(patient.variables) - known)
    for name in unknown:
        yield Finding("warning", "settings", f"{name} is set and nothing reads it", "correct its name or unset it")
    if not unknown:
        yield ok("settings", f"{len(patient.variables)} set, the rest at their defaults")


def check_versions(_patient: Patient) -> Iterator[Finding]:
    """Python and the libraries that the release asks for."""
    if sys.version_info < OLDEST_PYTHON:
        yield Finding("error", "versions", f"Python {platform.python_version()}", "install Python 3.11 or later")
    missing = [name for name in _required() if _version(name) is None]
    for name in missing:
        yield Finding("error", "versions", f"{name} is not installed", "install scattermark again")
    if not missing:
        shown = ", ".join(f"{name} {_version(name)}" for name in SHOWN)
        yield ok("versions", f"scattermark {version('scattermark')}, Python {platform.python_version()}, {shown}")


def check_folder(patient: Patient) -> Iterator[Finding]:
    """The data folder can be written to, and others cannot read the database in it."""
    folder = patient.settings.data_dir
    with tempfile.TemporaryFile(dir=folder):
        pass
    files = [path for path in folder.glob("*.db") if path.stat().st_mode & stat.S_IROTH]
    if files and folder.stat().st_mode & stat.S_IXOTH:
        yield Finding(
            "warning",
            "data folder",
            f"every user of this machine can read {files[0].name}",
            f"chmod o-rwx {folder}",
        )
    else:
        yield ok("data folder", str(folder.resolve()))


def check_leftovers(patient: Patient) -> Iterator[Finding]:
    """What killed processes left behind, and what nothing refers to."""
    report = look_around(patient.database, patient.photos, patient.now_s)
    if report.orphan_photographs or report.abandoned_files:
        yield Finding(
            "warning",
            "leftovers",
            f"{report.orphan_photographs} photographs that nothing refers to "
            f"({report.orphan_bytes / MEGABYTE:.1f} MB), {report.abandoned_files} abandoned uploads",
            "`scattermark purge` removes them; a worker that runs does so by itself",
        )
    oldest_s = patient.now_s - ABANDONED_AFTER_S
    paths = [path for pattern in LEFTOVERS for path in patient.settings.data_dir.glob(pattern)]
    abandoned = sorted(path.name for path in paths if path.stat().st_mtime < oldest_s)
    if abandoned:
        yield Finding(
            "warning",
            "leftovers",
            f"{len(abandoned)} files of backups or imports that were killed: {', '.join(abandoned)}",
            f"remove them from {patient.settings.data_dir}",
        )
    if not abandoned and not report.orphan_photographs and not report.abandoned_files:
        yield ok("leftovers", "none")


def _required() -> list[str]:
    """Names of the distributions that the release cannot do without."""
    wanted = [requirement for requirement in requires("scattermark") or () if "extra ==" not in requirement]
    return [found[0] for requirement in wanted if (found := re.match(r"[\w.-]+", requirement))]


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
