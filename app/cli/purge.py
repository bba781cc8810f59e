"""``scattermark purge``: remove what nobody needs any more; workers do the same every ten minutes."""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import asdict
from typing import TYPE_CHECKING

from app.cli.arguments import add_data_dir, add_json
from app.cli.installation import installation
from app.cli.migrate import settings_of

if TYPE_CHECKING:
    from app.services.housekeeping import HousekeepingReport

HELP = "remove expired snapshots, and files and detections that nothing refers to; the service may go on meanwhile"
MEGABYTE = 1e6


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("--dry-run", action="store_true", help="say what would be removed, remove nothing")
    add_data_dir(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Remove and say what."""
    from app.services.housekeeping import housekeep, look_around
    from app.storage.migrate import check_tables

    with installation(settings_of(arguments.data_dir)) as there:
        check_tables(there.database)
        keep_house = look_around if arguments.dry_run else housekeep
        report = keep_house(there.database, there.photos, time.time())
    if arguments.json:
        print(json.dumps({"dry_run": arguments.dry_run, **asdict(report)}))
    else:
        print(_sentence(report, "would be removed" if arguments.dry_run else "removed"))
    return 0


def _sentence(report: HousekeepingReport, verb: str) -> str:
    return (
        f"{verb}: {report.expired_snapshots} expired snapshots, {report.orphan_photographs} photographs that nothing "
        f"refers to ({report.orphan_bytes / MEGABYTE:.1f} MB), {report.stray_detections} detections of photographs "
        f"that are gone, {report.abandoned_files} abandoned files"
    )
