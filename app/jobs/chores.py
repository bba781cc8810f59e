"""What a worker does now and then beside its jobs, in a thread of its own, so that the jobs never wait for it."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Mapping

log = logging.getLogger(__name__)

INTERVAL_S = 600.0  # nothing of it is urgent: what is swept has been there for an hour or more


class Chores(threading.Thread):
    """Does each chore, one after the other, every ten minutes for as long as the process lives.

    Parameters
    ----------
    chores : mapping of str to callable
        Each may fail, be broken off by the end of the process, and be done by another worker at the same time.
    """

    def __init__(self, chores: Mapping[str, Callable[[], object]]) -> None:
        super().__init__(name="chores", daemon=True)
        self._chores = chores

    def run(self) -> None:
        """The thread's life."""
        while True:
            time.sleep(INTERVAL_S)
            self.do_all()

    def do_all(self) -> None:
        """Do each chore once; one that fails keeps no other from being done."""
        for name, chore in self._chores.items():
            try:
                log.info("%s: %s", name, chore())
            except Exception:
                log.exception("%s failed; it is tried again in %.0f s", name, INTERVAL_S)
