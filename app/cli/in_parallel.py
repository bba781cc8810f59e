"""One function over many items in worker processes, with progress."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import as_completed
from typing import Any, TypeVar

from app.cli.progress import Report
from app.jobs.pool import WorkerPool

Item = TypeVar("Item")
Result = TypeVar("Result")


def in_parallel(
    function: Callable[..., Result], items: Sequence[Item], constants: tuple[Any, ...], workers: int, report: Report
) -> list[Result]:
    """``function(item, *constants)`` of each item, in order; the first error ends the rest and is raised.

    Parameters
    ----------
    report : Report
        Told of the stage ``detecting``.
    """
    report("detecting", 0, len(items))
    with WorkerPool(min(workers, len(items)), queue_depth=len(items)) as pool:
        tasks = [pool.submit(function, item, *constants) for item in items]
        try:
            for done, task in enumerate(as_completed(tasks), start=1):
                task.result()
                report("detecting", done, len(items))
        except BaseException:
            for task in tasks:
                task.cancel()
            raise
        return [task.result() for task in tasks]
