"""The error so far as it changes: each new pair, whichever server took the sample or located the snapshot."""

from __future__ import annotations

import asyncio
import math
from collections.abc import AsyncIterator
from dataclasses import dataclass

from app.errors import NotFound
from app.services.live_evaluation import present_state
from app.services.trajectory_bell import TrajectoryBell, rung_or_late
from app.storage.database import Database
from app.storage.live_evaluations import LiveEvaluationRepository
from app.storage.live_records import LiveEvaluation, LivePair
from app.trajectories.metrics.running import ErrorSoFar, RunningErrors

PAIRS_AT_A_TIME = 500  # of a backlog: a read of a few milliseconds


@dataclass(frozen=True)
class LiveNews:
    """A new pair and what all pairs up to it amount to; ``pair`` is None for the last news of a closed one."""

    live: LiveEvaluation
    number: int
    pair: LivePair | None
    so_far: ErrorSoFar | None


async def watch_live(
    database: Database, bell: TrajectoryBell, live: LiveEvaluation, after: int
) -> AsyncIterator[LiveNews]:
    """The pairs of a live evaluation after one, until it is closed or deleted."""
    running = RunningErrors()
    number, so_far = 0, None
    with bell.heard(live.live_id, live.reference_id) as rung:
        while True:
            rung.clear()
            try:
                live, pairs = await asyncio.to_thread(_look, database, live.live_id, number)
            except NotFound:
                return  # deleted with its site or its reference: nothing more comes
            for number, pair in pairs:
                so_far = running.add(*distances_m(pair))
                if number > after:
                    yield LiveNews(live, number, pair, so_far)
            if number < live.pair_count:
                continue
            if live.closed_s is not None and not live.waiting_count:
                yield LiveNews(live, number, None, so_far)
                return
            await rung_or_late(rung)


def error_so_far(database: Database, live_id: str) -> tuple[LiveEvaluation, ErrorSoFar | None]:
    """The live evaluation with all pairs that can be by now, and what they amount to; None without a pair.

    Raises
    ------
    NotFound
    """
    running, so_far, told = RunningErrors(), None, 0
    while True:
        live, pairs = _look(database, live_id, told)
        for _, pair in pairs:
            so_far = running.add(*distances_m(pair))
        told += len(pairs)
        if told >= live.pair_count:
            return live, so_far


def distances_m(pair: LivePair) -> tuple[float, float]:
    """Lengths of a pair's error in the plan and in space; without a height the plan is all there is."""
    x_m, y_m, z_m = pair.error_m
    horizontal_m = math.hypot(x_m, y_m)
    return horizontal_m, math.hypot(horizontal_m, z_m or 0.0)


def _look(database: Database, live_id: str, after: int) -> tuple[LiveEvaluation, list[tuple[int, LivePair]]]:
    live = present_state(database, live_id)
    with database.reading() as session:
        return live, LiveEvaluationRepository(session).pairs(live_id, after, PAIRS_AT_A_TIME)
