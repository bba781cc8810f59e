"""``scattermark doctor``: look an installation over and say what to do about what is wrong with it."""

from __future__ import annotations

import argparse
import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.arguments import add_data_dir, add_json
from app.cli.installation import installation
from app.cli.migrate import settings_of
from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.services.doctor import Examination
    from app.settings import Settings

HELP = "look an installation over, change nothing, and say what to do about what is wrong with it"
SIGNS = {"ok": "ok  ", "warning": "warn", "error": "BAD "}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("--deep", action="store_true", help="read every photograph and every index of the database")
    add_data_dir(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Examine; 1 when something is broken."""
    from app.services.doctor import examine
    from app.services.doctor_findings import Patient
    from app.settings import PREFIX

    settings = settings_of(arguments.data_dir)
    _refuse_nothing(settings)
    variables = tuple(sorted(name for name in os.environ if name.startswith(PREFIX)))
    with installation(settings) as there:
        patient = Patient(settings, there.database, there.photos, variables, deep=arguments.deep)
        examination = examine(patient)
    _print(examination, as_json=arguments.json)
    return 1 if examination.verdict == "errors" else 0


def _refuse_nothing(settings: Settings) -> None:
    """Opening what is not there would make it."""
    if not settings.data_dir.is_dir():
        raise InvalidInput(f"there is no folder {settings.data_dir}: check --data-dir and SCATTERMARK_DATA_DIR")
    if settings.embedded and not Path(settings.sqlalchemy_url.partition(":///")[2]).is_file():
        raise InvalidInput(f"{settings.data_dir} holds no database: check --data-dir, or start `scattermark serve`")


def _print(examination: Examination, *, as_json: bool) -> None:
    if as_json:
        findings = [asdict(finding) for finding in examination.findings]
        print(json.dumps({"verdict": examination.verdict, "findings": findings}))
        return
    for finding in examination.findings:
        print(f"{SIGNS[finding.severity]} {finding.check}: {finding.what}")
        if finding.advice:
            print(f"     -> {finding.advice}")
    print(examination.sentence)
