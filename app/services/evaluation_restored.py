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
        availability=Availability(**record["availability"]),
    )


def _difference(record: dict[str, Any]) -> Difference:
    interval = record["mean_m"]
    mean_m = None if interval is None else Interval(**interval)
    return Difference(record["first"], record["second"], record["common"], mean_m)
