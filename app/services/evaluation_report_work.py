"""What a worker process does for one report of an evaluation, or for its series."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from app.services.evaluation_report.files import html_report, pdf_report, zip_report
from app.services.evaluation_report.material import ReportMaterial
from app.services.evaluation_restored import restored_differences, restored_evaluations
from app.services.workbench import workbench
from app.storage.evaluation_records import StoredEvaluation
from app.storage.evaluations import EvaluationRepository
from app.trajectories.association import Pairs
from app.trajectories.evaluation_options_record import options_of_record
from app.trajectories.metrics.errors import errors_of

FileFormat = Literal["html", "pdf", "zip"]

WRITERS: dict[FileFormat, Callable[[ReportMaterial], bytes]] = {
    "html": html_report,
    "pdf": pdf_report,
    "zip": zip_report,
}
SERIES_PAIRS = 2000  # of a series as JSON: more than a screen has columns; the zip holds all


@dataclass(frozen=True)
class ToldEvaluation:
    """An evaluation with the series of its systems, in their order."""

    stored: StoredEvaluation
    series: tuple[dict[str, Any], ...]


def write_evaluation_report(evaluation_id: str, wanted: FileFormat) -> bytes:
    """The report as the bytes of a file.

    Raises
    ------
    NotFound
    """
    with workbench().database.reading() as session:
        stored = EvaluationRepository(session).get(evaluation_id)
        evaluations = restored_evaluations(session, stored)
    material = ReportMaterial(
        title=stored.title,
        reference_name=stored.reference_name,
        evaluations=evaluations,
        differences=restored_differences(stored),
        zones=options_of_record(stored.options).zones,
    )
    return WRITERS[wanted](material)


def tell_evaluation(evaluation_id: str) -> ToldEvaluation:
    """An evaluation with its errors pair by pair.

    Raises
    ------
    NotFound
    """
    with workbench().database.reading() as session:
        repository = EvaluationRepository(session)
        stored = repository.get(evaluation_id)
        pairs = [repository.pairs(evaluation_id, number) for number in range(len(stored.systems))]
    return ToldEvaluation(stored, tuple(series_of_pairs(part) for part in pairs))


def series_of_pairs(pairs: Pairs) -> dict[str, Any]:
    """The errors of pairs; of many, every n-th."""
    every = -(-len(pairs) // SERIES_PAIRS)
    rows = np.arange(0, len(pairs), every)
    errors = errors_of(pairs).take(rows)
    angles_rad = errors.angles_rad
    return {
        "every": every,
        "time_s": errors.times_s.tolist(),
        "reference_m": pairs.reference.positions_m[rows].tolist(),
        "error_m": errors.vectors_m.tolist(),
        "angle_rad": None if angles_rad is None else angles_rad.tolist(),
    }
