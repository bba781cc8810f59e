"""The pool with real processes: whatever happens to one piece of work, the others are answered."""

from __future__ import annotations

import asyncio
import gc
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from app.errors import Cancelled, NotLocated, ServerFull, TimedOut, WorkerCrashed
from app.jobs.pool import WorkerPool
from tests.jobs import pool_work

ANSWER_S = 60.0  # how long a test waits before it calls an answer missing; no test needs that long


@pytest.fixture(scope="module")
def pool() -> Iterator[WorkerPool]:
    with WorkerPool(workers=2, queue_depth=1) as running:
        yield running


@pytest.fixture
def single() -> Iterator[WorkerPool]:
    with WorkerPool(workers=1, queue_depth=1) as running:
        yield running


def until(condition: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + ANSWER_S
    while not condition():
        assert time.monotonic() < deadline_s, "what the test waits for did not happen"
        time.sleep(0.005)


def is_gone(pid: int) -> bool:
    """Whether a process has ended; one that waits to be reaped has."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True


def test_a_result_comes_back(pool: WorkerPool) -> None:
    assert pool.submit(pool_work.double, 21).result(ANSWER_S) == 42


def test_a_coroutine_gets_the_result(pool: WorkerPool) -> None:
    assert asyncio.run(pool.run(pool_work.double, 4, timeout_s=ANSWER_S)) == 8


def test_errors_of_the_application_come_back_as_themselves(pool: WorkerPool) -> None:
    with pytest.raises(NotLocated) as caught:
        pool.submit(pool_work.refuse).result(ANSWER_S)
    assert caught.value.fields == {"reason": "no-targets", "advice": "move closer"}
    assert caught.value.detail == "no target was seen; move closer"


def test_unexpected_errors_bring_the_workers_traceback(pool: WorkerPool) -> None:
    with pytest.raises(ValueError, match="seven is not even") as caught:
        pool.submit(pool_work.raise_value_error).result(ANSWER_S)
    assert "raise_value_error" in caught.value.__notes__[0]


def test_an_error_that_cannot_travel_comes_back_as_text(pool: WorkerPool) -> None:
    with pytest.raises(RuntimeError, match="AwkwardError"):
        pool.submit(pool_work.raise_awkward).result(ANSWER_S)


def test_what_cannot_travel_fails_that_task_alone(pool: WorkerPool) -> None:
    with pytest.raises(RuntimeError, match="cannot leave the worker"):
        pool.submit(pool_work.unpicklable).result(ANSWER_S)
    with pytest.raises((AttributeError, TypeError)):
        pool.submit(pool_work.double, threading.Lock()).result(ANSWER_S)
    assert pool.submit(pool_work.double, 1).result(ANSWER_S) == 2


def test_a_crash_costs_one_task(pool: WorkerPool, tmp_path: Path) -> None:
    neighbour = pool.submit(pool_work.start_and_wait_for, tmp_path / "started", tmp_path / "release")
    until((tmp_path / "started").exists)
    with pytest.raises(WorkerCrashed):
        pool.submit(pool_work.die).result(ANSWER_S)
    assert pool.submit(pool_work.double, 3).result(ANSWER_S) == 6
    (tmp_path / "release").touch()
    assert neighbour.result(ANSWER_S) == "released"


def test_a_worker_killed_while_idle_costs_nothing(single: WorkerPool) -> None:
    first = single.submit(pool_work.worker_pid).result(ANSWER_S)
    os.kill(first, signal.SIGKILL)
    assert single.submit(pool_work.worker_pid).result(ANSWER_S) != first


def test_a_hang_is_ended_at_its_time_limit(pool: WorkerPool) -> None:
    with pytest.raises(TimedOut) as caught:
        pool.submit(pool_work.hang, timeout_s=0.05).result(ANSWER_S)
    assert caught.value.fields["timeout_s"] == 0.05
    assert pool.submit(pool_work.double, 5).result(ANSWER_S) == 10


def test_cancel_ends_the_running_task_and_its_worker(single: WorkerPool, tmp_path: Path) -> None:
    pid = single.submit(pool_work.worker_pid).result(ANSWER_S)
    task = single.submit(pool_work.start_and_wait_for, tmp_path / "started", tmp_path / "never")
    until((tmp_path / "started").exists)
    assert task.cancel()
    with pytest.raises(Cancelled):
        task.result(ANSWER_S)
    assert single.submit(pool_work.double, 1).result(ANSWER_S) == 2
    assert is_gone(pid)
    assert not task.cancel()


def test_cancel_takes_back_a_waiting_task_and_spares_the_worker(single: WorkerPool, tmp_path: Path) -> None:
    pid = single.submit(pool_work.worker_pid).result(ANSWER_S)
    running = single.submit(pool_work.start_and_wait_for, tmp_path / "started", tmp_path / "release")
    waiting = single.submit(pool_work.die)
    assert waiting.cancel()
    with pytest.raises(Cancelled):
        waiting.result(ANSWER_S)
    assert single.in_flight == 1
    (tmp_path / "release").touch()
    assert running.result(ANSWER_S) == "released"
    assert single.submit(pool_work.worker_pid).result(ANSWER_S) == pid


def test_a_full_pool_refuses_and_says_when_to_come_back(single: WorkerPool, tmp_path: Path) -> None:
    tasks = [single.submit(pool_work.start_and_wait_for, tmp_path / "started", tmp_path / "release") for _ in range(2)]
    with pytest.raises(ServerFull) as caught:
        single.submit(pool_work.double, 1)
    assert caught.value.fields["retry_after_s"] >= 1
    (tmp_path / "release").touch()
    for task in tasks:
        assert task.result(ANSWER_S) == "released"
    assert single.submit(pool_work.double, 1).result(ANSWER_S) == 2


def test_the_gate_opens_when_the_work_is_done_not_when_its_waiter_leaves(single: WorkerPool, tmp_path: Path) -> None:
    async def leave_early() -> None:
        waiter = asyncio.create_task(
            single.run(pool_work.start_and_wait_for, tmp_path / "started", tmp_path / "release")
        )
        while not (tmp_path / "started").exists():
            await asyncio.sleep(0.005)
        waiter.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiter

    asyncio.run(leave_early())
    assert single.in_flight == 1
    (tmp_path / "release").touch()
    until(lambda: single.in_flight == 0)


def test_a_waiter_that_leaves_before_its_turn_frees_its_place(single: WorkerPool, tmp_path: Path) -> None:
    async def leave_while_waiting() -> None:
        waiter = asyncio.create_task(single.run(pool_work.die))
        await asyncio.sleep(0)
        assert single.in_flight == 2
        waiter.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiter

    running = single.submit(pool_work.start_and_wait_for, tmp_path / "started", tmp_path / "release")
    until((tmp_path / "started").exists)
    asyncio.run(leave_while_waiting())
    assert single.in_flight == 1
    (tmp_path / "release").touch()
    assert running.result(ANSWER_S) == "released"


def test_workers_are_warm_when_start_returns_and_after_a_crash() -> None:
    with WorkerPool(1, 0, initializer=pool_work.mark, initargs=("warm",)) as pool:
        assert pool.submit(pool_work.marks).result(ANSWER_S) == ["warm"]
        with pytest.raises(WorkerCrashed):
            pool.submit(pool_work.die).result(ANSWER_S)
        assert pool.submit(pool_work.marks).result(ANSWER_S) == ["warm"]


def test_a_place_is_free_before_its_answer_is_known() -> None:
    """One worker and no queue: whoever has an answer may send the next piece of work at once."""
    with WorkerPool(1, 0) as pool:
        assert [pool.submit(pool_work.double, number).result(ANSWER_S) for number in range(300)] == list(
            range(0, 600, 2)
        )


def test_workers_that_cannot_start_are_reported_and_leave_nothing() -> None:
    pool = WorkerPool(2, 0, initializer=pool_work.fail_to_start)
    with pytest.raises(WorkerCrashed, match="no licence for this worker"):
        pool.start()
    assert pool.pids == ()


def test_a_task_that_is_done_leaves_nothing_for_the_garbage_collector(pool: WorkerPool) -> None:
    gc.disable()
    try:
        task = pool.submit(pool_work.double, 4)
        assert task.result() == 8
        gone = weakref.ref(task)
        del task
        deadline_s = time.monotonic() + 20.0
        while gone() is not None and time.monotonic() < deadline_s:
            time.sleep(0.005)  # its keeper turns to the next one
            pool.submit(pool_work.double, 1).result()
        assert gone() is None
    finally:
        gc.enable()


def test_a_pool_that_was_never_started_can_be_closed() -> None:
    WorkerPool(workers=1, queue_depth=0).close()


def test_a_worker_computes_on_one_thread(pool: WorkerPool) -> None:
    opencv_threads, blas_threads = pool.submit(pool_work.thread_counts).result(ANSWER_S)
    assert opencv_threads == 1
    assert blas_threads
    assert set(blas_threads) == {1}


def test_close_answers_everyone_and_leaves_no_process(tmp_path: Path) -> None:
    pool = WorkerPool(workers=1, queue_depth=1).start()
    pids = pool.pids
    running = pool.submit(pool_work.start_and_wait_for, tmp_path / "started", tmp_path / "never")
    until((tmp_path / "started").exists)
    waiting = pool.submit(pool_work.double, 1)
    pool.close(grace_s=0.0)
    for task in (running, waiting):
        with pytest.raises(Cancelled):
            task.result(ANSWER_S)
    assert all(is_gone(pid) for pid in pids)
    with pytest.raises(RuntimeError, match="not running"):
        pool.submit(pool_work.double, 1)


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
def test_workers_leave_when_their_parent_is_killed() -> None:
    command = [sys.executable, "-c", textwrap.dedent(PARENT)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=Path.cwd()) as parent:
        assert parent.stdout is not None
        pids = [int(pid) for pid in parent.stdout.readline().split()]
        assert len(pids) == 2
        parent.kill()
    until(lambda: all(is_gone(pid) for pid in pids))


PARENT = """
    import sys, threading
    from app.jobs.pool import WorkerPool
    from tests.jobs import pool_work

    if __name__ == "__main__":
        pool = WorkerPool(workers=2, queue_depth=0).start()
        pool.submit(pool_work.hang)  # one worker is busy, the other idle
        print(*pool.pids, flush=True)
        threading.Event().wait()
"""
