"""A stored evaluation as it was when it was made: the pairs are kept, and the same pairs give the same numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.geometry.similarity import Similarity
from app.storage.database import Session
from app.storage.evaluation_records import StoredEvaluation
from app.storage.evaluations import EvaluationRepository
from app.trajectories.alignment import Alignment
from app.trajectories.association import Pairs
from app.trajectories.comparison import Difference
from app.trajectories.evaluation import Evaluation, Match, judge
from app.trajectories.evaluation_options_record import options_of_record
from app.trajectories.metrics.availability import Availability
from app.trajectories.metrics.bootstrap import Interval
from app.trajectories.metrics.summary import Summary
from app.trajectories.time_offset import TimeOffset


def restored_evaluations(session: Session, stored: StoredEvaluation) -> dict[str, Evaluation]:
    """The evaluations of all systems by name."""
    options, repository = options_of_record(stored.options), EvaluationRepository(session)
    return {
        system.name: judge(_match(system.record, repository.pairs(stored.evaluation_id, number)), options)
        for number, system in enumerate(stored.systems)
    }


def restored_differences(stored: StoredEvaluation) -> tuple[Difference, ...]:
    """The paired differences."""
    return tuple(_difference(record) for record in stored.differences)


def _match(record: dict[str, Any], pairs: Pairs) -> Match:
    found = record["alignment"]
    similarity = Similarity(found["scale"], np.array(found["rotation"]), np.array(found["translation_m"]))
    return Match(
        pairs=pairs,
        time_offset=TimeOffset(**record["time_offset"]),
        alignment=Alignment(found["kind"], similarity, found["pairs_used"]),
        availability=_availability(record["availability"]),
    )


def _availability(record: dict[str, Any]) -> Availability:
    latency_s = record.get("latency_s")  # evaluations of older versions tell none
    return Availability(
        record["covered_share"], record["longest_silence_s"], None if latency_s is None else Summary(**latency_s)
    )


def _difference(record: dict[str, Any]) -> Difference:
    interval = record["mean_m"]
    mean_m = None if interval is None else Interval(**interval)
    return Difference(record["first"], record["second"], record["common"], mean_m)
