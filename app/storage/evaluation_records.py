"""Evaluations as they are kept: options and metrics as JSON, pairs as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from app.trajectories.association import Pairs


@dataclass(frozen=True)
class EvaluatedSystem:
    """One system of an evaluation.

    Attributes
    ----------
    trajectory_id : str or None
        None when the trajectory was removed since.
    name : str
        For people; unique in its evaluation.
    record : dict
        ``record_of_evaluation``.
    """

    trajectory_id: str | None
    name: str
    record: dict[str, Any]


@dataclass(frozen=True)
class NewEvaluation:
    """An evaluation on its way into the database.

    Attributes
    ----------
    options : dict
        ``record_of_options``.
    differences : list of dict
        ``record_of_difference`` of every two systems.
    systems : tuple of EvaluatedSystem
    pairs : tuple of Pairs
        Of each system, aligned.
    """

    site_id: str
    reference_id: str
    reference_name: str
    title: str
    options: dict[str, Any]
    differences: list[dict[str, Any]]
    systems: tuple[EvaluatedSystem, ...]
    pairs: tuple[Pairs, ...]


@dataclass(frozen=True)
class StoredEvaluation:
    """An evaluation without its pairs."""

    evaluation_id: str
    site_id: str
    reference_id: str | None
    reference_name: str
    title: str
    options: dict[str, Any]
    differences: list[dict[str, Any]]
    systems: tuple[EvaluatedSystem, ...]
    created_s: float
