"""``scattermark export SITE FILE``: one site in one file, for another installation."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from app.cli.arguments import add_data_dir, add_json
from app.cli.installation import installation
from app.cli.migrate import settings_of
from app.cli.progress import progress

HELP = "write one site with all that belongs to it into a file; the service may go on meanwhile"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("site", metavar="SITE", help="id of the site")
    parser.add_argument("file", type=Path, metavar="FILE", help="the archive; one of this name is replaced at the end")
    add_data_dir(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Export; fails when the store has lost photographs, although all the rest is written."""
    from app.services.site_transfer_export import SiteSource, export_site

    with installation(settings_of(arguments.data_dir)) as there, progress() as report:
        manifest = export_site(SiteSource(there.database, there.photos, arguments.site), arguments.file, report)
    told = manifest.photographs
    if arguments.json:
        record = {"file": str(arguments.file), "rows": manifest.rows, "photographs": told.count}
        print(json.dumps({**record, "missing": list(told.missing)}))
    else:
        print(f"{arguments.file}: {manifest.rows} rows and {told.count} photographs")
    if told.missing:
        print(f"scattermark export: {len(told.missing)} photographs are lost and left out", file=sys.stderr)
    return 1 if told.missing else 0
