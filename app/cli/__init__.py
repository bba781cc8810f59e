"""The command line: ``scattermark <command>``. One module per command; heavy imports wait until a command runs."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from typing import Any

from app.cli import (
    backup,
    build,
    calibrate,
    compile_,
    coverage,
    demo,
    detect,
    doctor,
    evaluate,
    export,
    guide,
    import_,
    keys,
    locate,
    migrate,
    purge,
    restore,
    serve,
    sheets,
    simulate,
    worker,
)
from app.errors import ScattermarkError

COMMANDS = {
    "serve": serve,
    "worker": worker,
    "demo": demo,
    "detect": detect,
    "guide": guide,
    "build": build,
    "calibrate": calibrate,
    "locate": locate,
    "evaluate": evaluate,
    "sheets": sheets,
    "coverage": coverage,
    "simulate": simulate,
    "keys": keys,
    "migrate": migrate,
    "purge": purge,
    "compile": compile_,
    "backup": backup,
    "restore": restore,
    "export": export,
    "import": import_,
    "doctor": doctor,
}

FAILED = 1
INTERRUPTED = 130  # the shell's convention for Ctrl-C
OUTPUT_CLOSED = 141  # and for a reader that went away


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Returns
    -------
    int
        0 when all went well, 1 when the input was bad or something was not located, 2 for wrong arguments.
    """
    parsed = parser().parse_args(arguments)
    try:
        return int(parsed.run(parsed))
    except ScattermarkError as error:
        _report(parsed, error.slug, error.detail, error.fields)
    except BrokenPipeError:
        # Python would complain once more when it flushes standard output at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return OUTPUT_CLOSED
    except OSError as error:
        _report(parsed, "os-error", f"{error.filename or 'system'}: {error.strerror or error}", {})
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    return FAILED


def _report(parsed: argparse.Namespace, slug: str, detail: str, fields: dict[str, Any]) -> None:
    if getattr(parsed, "json", False):
        print(json.dumps({"error": slug, "detail": detail, **fields}, default=str))
    print(f"scattermark {parsed.command}: {' '.join(detail.split())}", file=sys.stderr)


def parser() -> argparse.ArgumentParser:
    """All commands and their arguments."""
    top = argparse.ArgumentParser(
        prog="scattermark", description="Positions of photographs among surveyed targets, to millimetres."
    )
    top.add_argument("--version", action="version", version=version("scattermark"))
    commands = top.add_subparsers(dest="command", required=True, metavar="command")
    for name, command in COMMANDS.items():
        command_parser = commands.add_parser(name, help=command.HELP, description=command.HELP)
        command.configure(command_parser)
        command_parser.set_defaults(run=command.run)
    return top
