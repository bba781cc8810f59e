"""All that an evaluation's report tells."""

from __future__ import annotations

from dataclasses import dataclass

from app.trajectories.comparison import Difference
from app.trajectories.evaluation import Evaluation
from app.trajectories.metrics.zones import ELSEWHERE, Zone


@dataclass(frozen=True)
class ReportMaterial:
    """What a report is written from.

    Attributes
    ----------
    title : str
    reference_name : str
    evaluations : dict of Evaluation by system
        Against one reference, one at least, in the order in which they are shown.
    differences : tuple of Difference
        Paired, of every two systems.
    zones : tuple of Zone
        Those that the evaluations were told of: their outlines are drawn.
    """

    title: str
    reference_name: str
    evaluations: dict[str, Evaluation]
    differences: tuple[Difference, ...]
    zones: tuple[Zone, ...] = ()

    def __post_init__(self) -> None:
        if not self.evaluations:
            raise ValueError("a report tells of one evaluation at least")
        outlined = {*(zone.name for zone in self.zones), ELSEWHERE}
        told = {name for evaluation in self.evaluations.values() for name in evaluation.zones}
        if not told <= outlined:
            raise ValueError(f"the evaluations tell of zones {sorted(told - outlined)}: give their outlines")
