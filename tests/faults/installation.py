"""A whole installation in processes of its own, any of which can be killed: `scattermark serve` and what it starts."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx

from app.settings import Settings
from tests.api.serving import Served, environment_of, unhurried

PATIENCE_S = 300.0
MARK = "SCATTERMARK_TEST_INSTALLATION"  # in the environment of every process of one installation


class Installation:
    """One data folder, and the processes over it."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings = unhurried(settings)
        self._mark = uuid.uuid4().hex
        self._environment = {**environment_of(settings), MARK: self._mark, "SCATTERMARK_LOG_LEVEL": "warning"}
        self._roots: list[subprocess.Popen[str]] = []

    @contextmanager
    def serving(self, *options: str) -> Iterator[Served]:
        """The service, with its worker unless told otherwise; whatever is left of it in the end is killed."""
        service = self._start("serve", "--port", "0", *options)
        try:
            assert service.stdout is not None
            url = service.stdout.readline().split()[-1]
            with httpx.Client(base_url=url, timeout=PATIENCE_S) as client:
                yield Served(client, self.settings, None)  # type: ignore[arg-type]
        finally:
            self.kill_all()

    def start_worker(self) -> int:
        """A worker of its own, taking jobs; its process id."""
        worker = self._start("worker")
        assert worker.stdout is not None
        assert "is ready" in worker.stdout.readline()
        return worker.pid

    def pids(self, *words: str) -> list[int]:
        """Living processes of this installation whose command has these words."""
        found = []
        for folder in Path("/proc").iterdir():
            if folder.name.isdecimal() and self._is_ours(folder):
                command = (folder / "cmdline").read_bytes().split(b"\0")
                if all(word.encode() in command for word in words):
                    found.append(int(folder.name))
        return found

    def kill(self, *words: str) -> None:
        """kill -9 of the processes whose command has these words, and of nothing that they started."""
        for pid in self.pids(*words):
            os.kill(pid, signal.SIGKILL)
        self._reap()

    def kill_all(self) -> None:
        """End what is left of the installation."""
        while self.pids():
            self.kill()
            time.sleep(0.01)

    def await_end_of_all(self) -> None:
        """Wait until no process of the installation is left."""
        wait_until(lambda: not self.pids(), "processes are left behind")

    def _start(self, *arguments: str) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", "app.cli", *arguments, "--data-dir", str(self.settings.data_dir)]
        root = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=self._environment)
        self._roots.append(root)
        return root

    def _reap(self) -> None:
        for root in self._roots:
            root.poll()

    def _is_ours(self, folder: Path) -> bool:
        try:
            marked = f"{MARK}={self._mark}".encode() in (folder / "environ").read_bytes().split(b"\0")
            return marked and "Z" not in (folder / "stat").read_text().rpartition(")")[2].split()[0]
        except (FileNotFoundError, ProcessLookupError, PermissionError):
            return False

    def __enter__(self) -> Installation:
        return self

    def __exit__(self, *_: object) -> None:
        self.kill_all()
        for root in self._roots:
            root.communicate()


def wait_until(condition: Callable[[], bool], otherwise: str) -> None:
    deadline_s = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline_s, otherwise
        time.sleep(0.01)
