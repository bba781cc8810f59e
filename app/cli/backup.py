"""``scattermark backup FILE``: database and photographs in one file, while the service goes on."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.arguments import add_data_dir, add_json
from app.cli.installation import installation
from app.cli.migrate import settings_of
from app.cli.progress import progress

if TYPE_CHECKING:
    from app.services.backup import Backup

HELP = "write database and photographs into one file; the service may go on meanwhile"
DIGESTS_SHOWN = 5


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("file", type=Path, metavar="FILE", help="the backup; one of this name is replaced at the end")
    parser.add_argument("--no-photographs", action="store_true", help="rows only, as when the store has its own backup")
    add_data_dir(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Back up; fails when the store has lost photographs, although all the rest is written."""
    from app.services.backup import back_up

    with installation(settings_of(arguments.data_dir)) as there, progress() as report:
        photos = None if arguments.no_photographs else there.photos
        backup = back_up(there.database, photos, arguments.file, report)
    print(json.dumps(_record(arguments.file, backup)) if arguments.json else _sentence(arguments.file, backup))
    if backup.lost:
        shown = ", ".join(backup.lost[:DIGESTS_SHOWN])
        print(
            f"scattermark backup: {len(backup.lost)} photographs that the database names are lost or damaged in the "
            f"store, and so not in the backup ({shown} ...): `scattermark doctor --deep` says more",
            file=sys.stderr,
        )
    return 1 if backup.lost else 0


def _record(file: Path, backup: Backup) -> dict[str, object]:
    manifest = backup.manifest
    return {
        "file": str(file),
        "file_bytes": file.stat().st_size,
        "revision": manifest.heading.revision,
        "rows": {table.name: table.rows for table in manifest.tables},
        "photographs": manifest.photographs.count,
        "lost": list(backup.lost),
    }


def _sentence(file: Path, backup: Backup) -> str:
    manifest = backup.manifest
    return f"{file}: {manifest.rows} rows and {manifest.photographs.count} photographs, {file.stat().st_size} bytes"
