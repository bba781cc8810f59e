"""The process that workers are forked from."""

from __future__ import annotations

import sys
from multiprocessing import forkserver


def start_fork_server(module: str) -> None:
    """Have it import, once, all that workers need: not once per worker. Returns before it has."""
    if sys.platform == "win32":
        return
    forkserver.set_forkserver_preload([module])
    forkserver.ensure_running()
