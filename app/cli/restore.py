"""``scattermark restore FILE``: what a backup holds, into an empty installation."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from app.cli.arguments import add_data_dir, add_json
from app.cli.installation import installation
from app.cli.migrate import settings_of
from app.cli.progress import progress

HELP = "restore a backup, all of it or nothing, and bring it to the tables of this version"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("file", type=Path, metavar="FILE", help="what `scattermark backup` wrote")
    parser.add_argument("--force", action="store_true", help="remove what the database holds")
    add_data_dir(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Restore."""
    from app.services.backup_restore import Target, restore

    settings = settings_of(arguments.data_dir)
    if settings.embedded:
        settings.data_dir.mkdir(parents=True, exist_ok=True)
    with installation(settings) as there, progress() as report:
        target = Target(there.database, there.photos, replace=arguments.force)
        manifest = restore(arguments.file, target, report)
    told = manifest.photographs
    if arguments.json:
        rows = {table.name: table.rows for table in manifest.tables}
        print(json.dumps({"rows": rows, "photographs": told.count, "missing": list(told.missing)}))
        return 0
    print(f"restored {manifest.rows} rows and {told.count} photographs")
    if told.missing:
        print(f"{len(told.missing)} photographs were lost before the backup was made; it could not hold them")
    if not told.included:
        print("the backup was made without photographs: the store must hold them (`scattermark doctor` looks)")
    return 0
