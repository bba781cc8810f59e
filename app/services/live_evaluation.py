"""Live evaluations: opened on a trajectory, fed with samples, closed; any server may do each."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

from app.errors import Conflict, InvalidInput
from app.services.live_pairing import pair_waiting
from app.storage.database import Database, Session
from app.storage.live_evaluations import LiveEvaluationRepository
from app.storage.live_records import LiveEvaluation, LiveOptions, Sample
from app.storage.trajectories import TrajectoryRepository

GREATEST_DIGITS = 10  # of a number of pairs


def open_live(session: Session, reference_id: str, name: str, options: LiveOptions) -> LiveEvaluation:
    """A new live evaluation.

    Raises
    ------
    NotFound
    Conflict
        When the reference has positions only and a lever arm needs orientations.
    """
    reference = TrajectoryRepository(session).get(reference_id)
    if options.lever_arm_m is not None and not reference.oriented:
        raise Conflict("the reference has positions only, and a lever arm needs orientations; leave lever_arm_m out")
    return LiveEvaluationRepository(session).add(reference.site_id, reference_id, name, options)


def take_samples(database: Database, live_id: str, samples: Sequence[Sample]) -> tuple[LiveEvaluation, int]:
    """Keep samples with their arrival and pair what can be; the live evaluation as it stands, how many were new.

    Raises
    ------
    NotFound
    Conflict
        When it is closed.
    """
    arrived_s = time.time()
    arrived = [replace(sample, arrived_s=arrived_s) for sample in samples]
    with database.recording() as session:
        added = LiveEvaluationRepository(session).add_samples(live_id, arrived)
        return pair_waiting(session, live_id), added


def present_state(database: Database, live_id: str) -> LiveEvaluation:
    """The live evaluation with all pairs that can be by now.

    Raises
    ------
    NotFound
    """
    with database.reading() as session:
        live = LiveEvaluationRepository(session).get(live_id)
        reference = TrajectoryRepository(session).get(live.reference_id)
    news = reference.snapshot_count > live.seen_ordinal or reference.closed_s is not None
    if not (live.waiting_count and (news or live.closed_s is not None)):
        return live
    with database.recording() as session:
        return pair_waiting(session, live_id)


def close_live(session: Session, live_id: str) -> LiveEvaluation:
    """Take no more samples; those that still wait are missed. Closing twice is closing once.

    Raises
    ------
    NotFound
    """
    live = LiveEvaluationRepository(session).close(live_id)
    while live.waiting_count:
        live = pair_waiting(session, live_id)
    return live


def first_pair(live: LiveEvaluation, last_event_id: str | None) -> int:
    """The pair after which a stream begins: what the client saw last, else what there is now.

    Raises
    ------
    InvalidInput
        For an id that no event had.
    """
    if last_event_id is None:
        return live.pair_count
    plausible = last_event_id.isascii() and last_event_id.isdigit() and len(last_event_id) <= GREATEST_DIGITS
    if not plausible or int(last_event_id) > live.pair_count:
        raise InvalidInput(
            f"no event had the id {last_event_id!r}; send the last one that came, 0 for all, or none for what comes",
            field="Last-Event-ID",
        )
    return int(last_event_id)
