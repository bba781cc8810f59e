"""``scattermark compile``: compile the measuring loops now, so that no first start has to."""

from __future__ import annotations

import argparse
import subprocess
import sys

from app.errors import ScattermarkError

HELP = "compile the measuring loops for this machine, which a first start does otherwise"
COMMAND = "compile"


class CannotCompile(ScattermarkError):
    """The measuring loops could not be compiled."""

    slug = "cannot-compile"


def configure(_parser: argparse.ArgumentParser) -> None:
    """Nothing to choose."""


def run(_arguments: argparse.Namespace) -> int:
    """Compile what is not compiled yet, and say where it stands."""
    import app.services.workers  # noqa: F401 - imports every module that has loops
    from app.compiled import can_be_kept, is_kept, note_all_kept

    note_all_kept()
    if not can_be_kept():
        print("compiled, but no folder can be written to keep it: set NUMBA_CACHE_DIR to one that can", file=sys.stderr)
    return 0 if is_kept() else 1


def compile_first() -> None:
    """Compile in a process of its own when this machine has not, before several processes do it at once.

    Raises
    ------
    CannotCompile
    """
    from app.compiled import can_be_kept, is_kept

    if is_kept() or not can_be_kept():
        return
    print("compiling the measuring loops: once on this machine, about half a minute", file=sys.stderr, flush=True)
    done = subprocess.run([sys.executable, "-m", "app.cli", COMMAND], check=False)
    if done.returncode != 0:
        raise CannotCompile("the measuring loops did not compile; the lines above say why, and a reinstall may mend it")
