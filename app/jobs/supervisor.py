"""A worker as a child of the service: started with it, started again when it dies, ended with it."""

from __future__ import annotations

import logging
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

log = logging.getLogger(__name__)

FIRST_PAUSE_S = 0.5
LONGEST_PAUSE_S = 10.0  # with a start of a few seconds, a worker that was killed is back within half a minute
STEADY_S = 60.0  # a worker that lived so long died of something new
STOP_TIMEOUT_S = 9.0  # longer than the worker's own limit


@contextmanager
def supervised_worker(data_dir: Path, environment: Mapping[str, str] | None = None) -> Iterator[Supervisor]:
    """Have a worker over a data folder for as long as the block lasts; without an environment it has this process's."""
    supervisor = Supervisor(data_dir, environment)
    supervisor.start()
    try:
        yield supervisor
    finally:
        supervisor.stop()


class Supervisor(threading.Thread):
    """Keeps one worker process alive.

    The worker holds one end of a pipe as its standard input; when this process dies, however, it sees the other end
    close and leaves.
    """

    def __init__(self, data_dir: Path, environment: Mapping[str, str] | None = None) -> None:
        super().__init__(name="worker-supervisor", daemon=True)
        self._data_dir = data_dir
        self._environment = environment
        self._stopping = threading.Event()
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def pid(self) -> int | None:
        """Process id of the worker; None while there is none."""
        process = self._process
        return None if process is None or process.returncode is not None else process.pid

    def run(self) -> None:
        """The thread's life."""
        pause_s = FIRST_PAUSE_S
        while (process := self._begin()) is not None:
            began_s = time.monotonic()
            status = process.wait()
            if self._stopping.is_set():
                return
            if time.monotonic() - began_s > STEADY_S:
                pause_s = FIRST_PAUSE_S
            log.warning("the worker ended with status %d; it is started again in %g s", status, pause_s)
            self._stopping.wait(pause_s)
            pause_s = min(2 * pause_s, LONGEST_PAUSE_S)

    def stop(self) -> None:
        """End the worker in order, by force if it takes too long."""
        self._stopping.set()
        with self._lock:
            process = self._process
        if process is not None:
            process.terminate()
            try:
                process.wait(STOP_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                process.kill()
        self.join()
        if process is not None and process.stdin is not None:
            process.stdin.close()

    def _begin(self) -> subprocess.Popen[bytes] | None:
        """A new worker; None when none is wanted any more."""
        command = [sys.executable, "-m", "app.cli", "worker", "--supervised", "--data-dir", str(self._data_dir)]
        with self._lock:
            if self._stopping.is_set():
                return None
            if self._process is not None and self._process.stdin is not None:
                self._process.stdin.close()
            self._process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, env=self._environment
            )
            return self._process
