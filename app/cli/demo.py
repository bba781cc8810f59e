"""``scattermark demo``: survey a room and locate its snapshots in the real service, then score them with the truth."""

from __future__ import annotations

import argparse
from pathlib import Path

from app.cli.arguments import FAMILIES, add_json, positive

DEFAULT_ROOM = Path("examples/room")

HELP = "survey a room and locate snapshots in it, over HTTP"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("room", type=Path, nargs="?", default=DEFAULT_ROOM, help=f"a room's folder ({DEFAULT_ROOM})")
    parser.add_argument("--family", default="golay", choices=FAMILIES, help="code family of the plates (golay)")
    parser.add_argument("--u-mm", type=positive, help="printed module of the plates in mm (the room's own)")
    parser.add_argument("--keep", action="store_true", help="keep the service running afterwards")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Tell both stories, print the table."""
    from app.cli.demo_run import run_demo

    return run_demo(arguments)
