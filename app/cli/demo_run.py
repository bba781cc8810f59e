"""The demo's course: start the service, survey, locate, score, show."""

from __future__ import annotations

import argparse
import contextlib
import json
import sys
import tempfile
import threading
from pathlib import Path

from app.cli.compile_ import compile_first
from app.cli.demo_service import running_service
from app.cli.demo_story import Surveyed, locate_room, survey_room
from app.cli.demo_table import print_scores, print_survey, results_to_json
from app.cli.progress import Report, progress
from app.cli.room import Room, has_truth, open_room, true_shots
from app.cli.score import Located, SnapshotScore, score_snapshot
from app.cli.service_client import ServiceClient
from app.errors import InvalidInput

MM_PER_M = 1000.0


def run_demo(arguments: argparse.Namespace) -> int:
    """Tell both stories, print the table."""
    room = open_room(arguments.room, None if arguments.u_mm is None else arguments.u_mm / MM_PER_M)
    compile_first()
    with tempfile.TemporaryDirectory(prefix="scattermark-demo-") as folder, running_service(Path(folder)) as url:
        client = ServiceClient(url)
        with contextlib.closing(client), progress() as report:
            surveyed, located = _stories(client, room, arguments.family, report)
        scores = _scores(room, located)
        if arguments.json:
            print(json.dumps(results_to_json(surveyed, located, scores)), flush=True)
        else:
            print_survey(surveyed)
            print_scores(located, scores)
        if arguments.keep:
            _wait(url, surveyed.site_id, room)
    if not (arguments.keep or arguments.json):
        print(f"\nTo keep the service running and try it: {_program()} demo {arguments.room} --keep")
    return 0


def _program() -> str:
    """How this command line was called."""
    return sys.argv[0] if Path(sys.argv[0]).name == "scattermark" else f"{sys.executable} -m app.cli"


def _stories(client: ServiceClient, room: Room, family: str, report: Report) -> tuple[Surveyed, list[Located]]:
    surveyed = survey_room(client, room, family, report)
    return surveyed, list(locate_room(client, surveyed.site_id, room, report))


def _scores(room: Room, located: list[Located]) -> list[SnapshotScore] | None:
    """Scores of all snapshots; None for a room without truth."""
    if not has_truth(room):
        return None
    truth = true_shots(room.folder / "locate").shots
    missing = sorted({one.name for one in located} - set(truth))
    if missing:
        raise InvalidInput(f"{room.folder}/locate/truth.json says nothing about {', '.join(missing)}")
    return [score_snapshot(one, truth[one.name].site_from_cam) for one in located]


def _wait(url: str, site_id: str, room: Room) -> None:
    """Keep the service until Ctrl-C."""
    snapshot = room.snapshots[0]
    print(f"\nThe service runs at {url} ({url}/docs lists its calls) until you press Ctrl-C. Try:")
    print(
        f"  curl -H 'Content-Type: image/jpeg' --data-binary @{snapshot} '{url}/locate?site_id={site_id}'", flush=True
    )
    with contextlib.suppress(KeyboardInterrupt):
        threading.Event().wait()
