"""Live evaluations on both databases, fed and asked by several servers at once."""

from __future__ import annotations

import threading
from dataclasses import replace

import pytest

from app.errors import Conflict, NotFound
from app.services.live_evaluation import close_live, open_live, present_state, take_samples
from app.services.live_events import error_so_far
from app.storage.database import Database
from app.storage.live_evaluations import LiveEvaluationRepository
from app.storage.live_records import LiveOptions, Sample
from tests.storage.walks import START_S, Step, add_steps, add_walk, new_site

OPTIONS = LiveOptions(max_gap_s=2.0, lever_arm_m=(0.0, 0.0, 0.0), floor_height_m=3.0)


def at(after_s: float) -> Sample:
    return Sample(START_S + after_s, after_s, 2.0, 1.5, 0, (0.0, 0.0, 0.0, 1.0))


def opened(database: Database) -> tuple[str, str, str]:
    """A live evaluation, its reference with one pose, the site."""
    site_id = new_site(database)
    reference_id = add_walk(database, site_id, [Step(0.0, (0.0, 2.0, 1.5))])
    with database.writing() as session:
        return open_live(session, reference_id, "uwb", OPTIONS).live_id, reference_id, site_id


def test_what_is_kept_is_what_was_told(database: Database) -> None:
    live_id, reference_id, site_id = opened(database)
    live, added = take_samples(database, live_id, [at(1.0), at(0.5), at(1.0)])
    assert (added, live.sample_count, live.waiting_count) == (2, 2, 2)
    assert (live.reference_id, live.site_id, live.name, live.options) == (reference_id, site_id, "uwb", OPTIONS)
    with database.reading() as session:
        waiting = LiveEvaluationRepository(session).waiting(live_id, 10)
        kept = LiveEvaluationRepository(session).samples(live_id)
    assert [replace(sample, arrived_s=None) for _, sample in waiting] == [at(0.5), at(1.0)]
    assert kept == [sample for _, sample in waiting]
    assert all(sample.arrived_s is not None for sample in kept)


def test_pairs_are_numbered_once_whoever_looks(database: Database) -> None:
    live_id, reference_id, site_id = opened(database)

    def look() -> None:
        for _ in range(5):
            present_state(database, live_id)

    def send(first: int) -> None:
        for number in range(first, 40, 4):
            take_samples(database, live_id, [at(number / 40), at(number / 40)])

    workers = [threading.Thread(target=look) for _ in range(3)]
    workers += [threading.Thread(target=send, args=(first,)) for first in range(4)]
    for worker in workers:
        worker.start()
    add_steps(database, reference_id, site_id, [Step(1.0, (1.0, 2.0, 1.5))])
    for worker in workers:
        worker.join()
    live, tally = error_so_far(database, live_id)
    so_far = tally.so_far
    assert so_far is not None
    assert (live.sample_count, live.pair_count, live.waiting_count, so_far.count) == (40, 40, 0, 40)
    assert so_far.rmse_m == pytest.approx(0.0, abs=1e-6)  # stamps since 1970 are 0.2 microseconds apart
    with database.reading() as session:
        numbers = [number for number, _ in LiveEvaluationRepository(session).pairs(live_id, 0, 100)]
    assert numbers == list(range(1, 41))


def test_closed_is_closed(database: Database) -> None:
    live_id, _, _ = opened(database)
    take_samples(database, live_id, [at(0.0), at(0.5)])
    with database.writing() as session:
        closed = close_live(session, live_id)
        assert close_live(session, live_id) == closed
    assert (closed.pair_count, closed.missed_count, closed.waiting_count) == (1, 1, 0)
    with pytest.raises(Conflict, match="is closed"):
        take_samples(database, live_id, [at(1.0)])
    with database.writing() as session:
        LiveEvaluationRepository(session).remove(live_id)
    with pytest.raises(NotFound, match="no live evaluation"):
        present_state(database, live_id)
