"""Processes that are killed, stopped or out of memory while they work: one request pays at most, none is lost."""

from __future__ import annotations

import os
import resource
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from multiprocessing import forkserver
from pathlib import Path

import httpx
import pytest

from app.jobs import worker_process
from app.settings import Settings
from tests.api.serving import hurried, serve
from tests.faults.hostile_pictures import endless_scans, png
from tests.faults.ledger import Ledger, wait_until

pytestmark = pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are looked at in /proc")

LIMIT_S = 5.0
LONG = endless_scans(2000)  # far longer than the limit
LARGE = png(6000, 5000)  # 90 MB once decoded
ROOM_BYTES = 32 * 2**20  # less than that

RESTART_S = 240.0  # of a loaded machine
AT_WORK_S = 0.1  # of processor time: an idle worker uses none, and one that has just started hardly any


@pytest.fixture(scope="module")
def narrow(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ledger]:
    """One worker."""
    settings = Settings(data_dir=tmp_path_factory.mktemp("narrow"), locate_workers=1, build_workers=1)
    with serve(settings, worker=False) as running, closing(Ledger(running)) as kept:
        yield kept


@pytest.fixture(autouse=True)
def nothing_is_lost(narrow: Ledger) -> Iterator[None]:
    yield
    narrow.check()


def worker_pid(ledger: Ledger) -> int:
    deadline_s = time.monotonic() + RESTART_S  # one that died is being replaced
    while not (pids := ledger.served.services.locator._pool.pids):
        assert time.monotonic() < deadline_s, "no worker came"
        time.sleep(0.01)
    assert len(pids) == 1
    return pids[0]


@contextmanager
def locating(ledger: Ledger, picture: bytes, answers: list[httpx.Response]) -> Iterator[int]:
    """A snapshot that a worker is at; the worker's process id."""
    pid = worker_pid(ledger)
    request = threading.Thread(target=lambda: answers.append(ledger.locate(picture)))
    spent_s = _processor_s(pid)
    request.start()
    wait_until(lambda: _processor_s(pid) > spent_s + AT_WORK_S, "the worker does nothing")
    yield pid
    request.join()


def _processor_s(pid: int) -> float:
    """Processor time that a process has used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def test_a_worker_killed_at_its_work_costs_that_request(narrow: Ledger) -> None:
    answers: list[httpx.Response] = []
    with locating(narrow, LONG, answers) as pid:
        os.kill(pid, signal.SIGKILL)
    assert answers[0].status_code == 500
    assert answers[0].json()["type"].endswith("/worker-crashed")
    assert narrow.locate().status_code == 200


def test_a_worker_killed_while_idle_costs_nothing(narrow: Ledger) -> None:
    os.kill(worker_pid(narrow), signal.SIGKILL)
    assert narrow.locate().status_code == 200


def test_a_worker_stopped_at_its_work_is_replaced(narrow: Ledger) -> None:
    answers: list[httpx.Response] = []
    with hurried(narrow.served, LIMIT_S), locating(narrow, LONG, answers) as pid:
        os.kill(pid, signal.SIGSTOP)
    assert answers[0].status_code == 504
    assert narrow.locate().status_code == 200
    assert worker_pid(narrow) != pid


@pytest.mark.parametrize("size", [1, 4])  # a snapshot, and one of more bytes than a pipe holds
def test_a_worker_stopped_while_idle_costs_nothing(narrow: Ledger, monkeypatch: pytest.MonkeyPatch, size: int) -> None:
    monkeypatch.setattr(worker_process, "TAKE_TIMEOUT_S", 1)
    os.kill(worker_pid(narrow), signal.SIGKILL)  # the next one's pipe has the short limit
    assert narrow.locate().status_code == 200
    os.kill(worker_pid(narrow), signal.SIGSTOP)
    answer = narrow.locate() if size == 1 else narrow.locate(LARGE + bytes(2**20))
    assert answer.status_code in (200, 422)


def test_the_death_of_the_process_that_workers_come_from_costs_nothing(narrow: Ledger) -> None:
    origin = forkserver._forkserver._forkserver_pid  # type: ignore[attr-defined]
    os.kill(origin, signal.SIGKILL)
    assert narrow.locate().status_code == 200
    os.kill(worker_pid(narrow), signal.SIGKILL)
    assert narrow.locate().status_code == 200


def test_a_worker_without_memory_refuses_and_goes_on(narrow: Ledger) -> None:
    pid = worker_pid(narrow)
    taken_bytes = int(Path(f"/proc/{pid}/statm").read_text().split()[0]) * resource.getpagesize()
    resource.prlimit(pid, resource.RLIMIT_AS, (taken_bytes + ROOM_BYTES, taken_bytes + ROOM_BYTES))
    answer = narrow.locate(LARGE)
    assert answer.status_code == 503, answer.text
    assert answer.json()["type"].endswith("/out-of-memory")
    assert narrow.locate().status_code == 200
