"""Progress on standard error: a bar on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

LINES_PER_STAGE = 5  # without a terminal: enough to see that it lives, few enough for a log


class Report(Protocol):
    """Where work says how far it is."""

    def __call__(self, stage: str, done: int, total: int, /) -> None:
        """``done`` of ``total`` pieces of a stage; a total of 0 means that nobody knows."""


@contextmanager
def progress() -> Iterator[Report]:
    """A report that is drawn on standard error until the block ends."""
    if sys.stderr.isatty():
        with _bars() as report:
            yield report
    else:
        yield _Lines()


@contextmanager
def _bars() -> Iterator[Report]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description:<24}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as bars:
        stages: dict[str, TaskID] = {}

        def report(stage: str, done: int, total: int) -> None:
            if stage not in stages:
                stages[stage] = bars.add_task(stage)
            bars.update(stages[stage], completed=done, total=total or None)

        yield report


class _Lines:
    """Progress as lines of text."""

    def __init__(self) -> None:
        self._stage = ""
        self._shown = 0

    def __call__(self, stage: str, done: int, total: int) -> None:
        step = max(1, total // LINES_PER_STAGE)
        if stage != self._stage:
            self._stage, self._shown = stage, 0
        elif done <= self._shown or (done < self._shown + step and done != total):
            return
        self._shown = done
        count = f" {done}/{total}" if total else ""
        print(f"{stage}{count}", file=sys.stderr, flush=True)
