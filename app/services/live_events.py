"""The error so far as it changes: each new pair, whichever server took the sample or located the snapshot."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from dataclasses import dataclass

from app.errors import NotFound
from app.services.live_evaluation import present_state
from app.services.live_tally import LiveTally, Tally
from app.services.trajectory_bell import TrajectoryBell, rung_or_late
from app.storage.database import Database
from app.storage.live_evaluations import LiveEvaluationRepository
from app.storage.live_records import LiveEvaluation, LivePair

PAIRS_AT_A_TIME = 500  # of a backlog: a read of a few milliseconds


@dataclass(frozen=True)
class LiveNews:
    """A new pair in the reference's frame, none with the last news, and what all pairs up to it amount to."""

    live: LiveEvaluation
    number: int
    pair: LivePair | None
    tally: Tally


async def watch_live(
    database: Database, bell: TrajectoryBell, live: LiveEvaluation, after: int
) -> AsyncIterator[LiveNews]:
    """The pairs of a live evaluation after one, until it is closed or deleted."""
    counted, number = LiveTally(live.options), 0
    with bell.heard(live.live_id, live.reference_id) as rung:
        while True:
            rung.clear()
            try:
                live, pairs = await asyncio.to_thread(_look, database, live.live_id, number)
            except NotFound:
                return  # deleted with its site or its reference: nothing more comes
            for number, pair in pairs:
                counted.add(pair)
                if number > after:
                    yield LiveNews(live, number, counted.shown(pair), counted.tally)
            if number < live.pair_count:
                continue
            if live.closed_s is not None and not live.waiting_count:
                yield LiveNews(live, number, None, counted.tally)
                return
            await rung_or_late(rung)


def error_so_far(database: Database, live_id: str) -> tuple[LiveEvaluation, Tally]:
    """The live evaluation with all pairs that can be by now, and what they amount to.

    Raises
    ------
    NotFound
    """
    live, pairs = _look(database, live_id, 0)
    counted, told = LiveTally(live.options), 0
    while True:
        for _, pair in pairs:
            counted.add(pair)
        told += len(pairs)
        if told >= live.pair_count:
            return live, counted.tally
        live, pairs = _look(database, live_id, told)


def _look(database: Database, live_id: str, after: int) -> tuple[LiveEvaluation, list[tuple[int, LivePair]]]:
    live = present_state(database, live_id)
    with database.reading() as session:
        return live, LiveEvaluationRepository(session).pairs(live_id, after, PAIRS_AT_A_TIME)
