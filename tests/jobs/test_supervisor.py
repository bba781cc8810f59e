"""A worker beside the service: started again when it dies, gone when it is told to go or its parent dies."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from app.jobs import supervisor
from app.jobs.supervisor import supervised_worker
from tests.faults.installation import wait_until

PARENT = """
import sys, time
from pathlib import Path
from app.jobs.supervisor import supervised_worker
with supervised_worker(Path(sys.argv[1])) as worker:
    while worker.pid is None:
        time.sleep(0.01)
    print(worker.pid, flush=True)
    time.sleep(600)
"""


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_worker_that_dies_is_started_again_and_goes_in_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(supervisor, "FIRST_PAUSE_S", 0.01)
    with supervised_worker(tmp_path) as worker:
        wait_until(lambda: worker.pid is not None, "no worker")
        first = worker.pid
        assert first is not None
        os.kill(first, signal.SIGKILL)
        wait_until(lambda: worker.pid not in (None, first), "no other worker")
        second = worker.pid
        assert second is not None
    assert not alive(second)
    worker.stop()  # once more: nothing is left to be done


def test_a_worker_goes_with_its_parent_however_that_dies(tmp_path: Path) -> None:
    parent = subprocess.Popen([sys.executable, "-c", PARENT, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    pid = int(parent.stdout.readline())
    parent.kill()
    parent.communicate()
    wait_until(lambda: not alive(pid), "the worker is an orphan")


def test_the_service_never_imports_the_engine() -> None:
    asked = "import sys, app.main, app.jobs.supervisor, app.cli.serve; sys.exit('dbos' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", asked], check=False).returncode == 0
