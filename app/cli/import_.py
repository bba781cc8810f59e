"""``scattermark import FILE``: a site that was exported elsewhere."""

from __future__ import annotations

import argparse
import json
import socket
import tempfile
from dataclasses import asdict
from pathlib import Path

from app.cli.arguments import add_data_dir, add_json
from app.cli.installation import installation
from app.cli.migrate import settings_of
from app.cli.progress import progress

NAME = "command line"  # who acts, in the audit
HELP = "take in a site that was exported elsewhere, all of it or nothing; the service may go on meanwhile"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("file", type=Path, metavar="FILE", help="what `scattermark export` wrote")
    parser.add_argument(
        "--as-new", action="store_true", help="give everything new ids, so that the site can be beside its original"
    )
    add_data_dir(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Import."""
    from app.services.site_transfer_import import ImportLimits, SiteTarget, import_site
    from app.services.storage_budget import StorageBudget, StorageLimits
    from app.storage.audit import Actor, noting
    from app.storage.migrate import check_tables
    from app.vision.photo import PhotoLimits

    settings = settings_of(arguments.data_dir)
    photo = PhotoLimits(settings.max_photo_bytes, settings.max_photo_pixels)
    with (
        arguments.file.open("rb") as file,
        installation(settings) as there,
        tempfile.TemporaryDirectory() as scratch,
        progress() as report,
    ):
        check_tables(there.database)
        room = StorageLimits(settings.quota_bytes, settings.min_free_bytes)
        budget = StorageBudget(there.database, there.photos, room)
        limits = ImportLimits(photo, Path(scratch))
        target = SiteTarget(there.database, there.photos, budget, limits, arguments.as_new)
        with noting(Actor(None, NAME, socket.gethostname()), "import", {}):
            imported = import_site(file, target, report)
    if arguments.json:
        print(json.dumps(asdict(imported)))
        return 0
    print(f"site {imported.site_id}: {imported.rows} rows and {imported.photographs} photographs")
    if imported.left_out:
        print(f"{len(imported.left_out)} photographs were not in the archive and are left out of their surveys")
    return 0
