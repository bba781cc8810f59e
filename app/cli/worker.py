"""``scattermark worker``: the process that builds maps; run as many as there are machines for it."""

from __future__ import annotations

import argparse
import logging
import os
import signal
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from app.cli.compile_ import compile_first
from app.cli.migrate import migrate, settings_of
from app.errors import ScattermarkError

if TYPE_CHECKING:
    from app.settings import Settings

log = logging.getLogger(__name__)

FAULTY = 1
HELP = "do the builds that the service was asked for"
STOP_LIMIT_S = 8.0  # of a stop in order, which takes a fraction of a second unless the database hangs


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("--data-dir", type=Path, help="folder of photographs and database (SCATTERMARK_DATA_DIR)")
    parser.add_argument("--supervised", action="store_true", help="end when standard input is closed")


def run(arguments: argparse.Namespace) -> int:
    """Work until told to stop."""
    from app.cli.serve import start_logs

    compile_first()
    settings = settings_of(arguments.data_dir)
    start_logs(settings)
    stop = _stopped_by_signals()
    if arguments.supervised:
        threading.Thread(target=_stop_with_parent, args=(stop,), name="parent-watch", daemon=True).start()
    if settings.embedded:
        migrate(settings)
    _leave(_work(settings, stop))


def _work(settings: Settings, stop: threading.Event) -> int:
    """Work; the exit status. No error leaves: the interpreter would then wait for threads that never end."""
    from app.jobs.build_worker import run_worker

    try:
        return run_worker(settings, stop, lambda name: print(f"Scattermark worker {name} is ready", flush=True))
    except ScattermarkError as error:
        print(f"scattermark worker: {' '.join(error.detail.split())}", file=sys.stderr)
    except Exception:
        log.exception("the worker ends by a fault of its own; another one goes on with its work")
    return FAULTY


def _stopped_by_signals() -> threading.Event:
    stop = threading.Event()

    def ask(_number: int, _frame: object) -> None:
        _give_up_later()
        stop.set()

    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, ask)
    return stop


def _stop_with_parent(stop: threading.Event) -> None:
    """The parent holds the other end of standard input and never writes: when it dies, however, this end closes."""
    while sys.stdin.buffer.read(1):
        pass
    _give_up_later()
    stop.set()


def _give_up_later() -> None:
    """End the process even when the database hangs: another worker finds out by itself what was left."""
    limit = threading.Timer(STOP_LIMIT_S, os._exit, (FAULTY,))
    limit.daemon = True
    limit.start()


def _leave(status: int) -> NoReturn:
    """End at once: threads wait for work that is someone else's from now on. Pool processes end with this one."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)
