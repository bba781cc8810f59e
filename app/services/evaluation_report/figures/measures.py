"""The sizes of an error that figures show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.units import DEGREES, METRES, Unit, length_unit
from app.trajectories.evaluation import Evaluation

Array = npt.NDArray[np.float64]
Part = Literal["horizontal", "vertical", "spatial", "rotation"]


@dataclass(frozen=True)
class Measure:
    """A size of errors: which part of them, how an axis and how a sentence names it, and its unit."""

    part: Part
    title: str
    words: str
    unit: Unit = METRES

    def unit_up_to(self, end: float) -> Unit:
        """The unit of an axis that goes so far."""
        return length_unit(end) if self.unit is METRES else self.unit

    def along(self, unit: Unit) -> str:
        """The title of an axis."""
        return f"{self.title}, {unit.name}"

    def of(self, evaluation: Evaluation) -> Array:
        """Sizes in the measure's unit, shape (K,); none for rotations when there are no orientations."""
        errors = evaluation.errors
        if self.part == "rotation":
            angles_rad = errors.angles_rad
            return np.zeros(0) if angles_rad is None else np.degrees(angles_rad)
        if self.part == "horizontal":
            return errors.horizontal_m
        return errors.vertical_m if self.part == "vertical" else errors.spatial_m


HORIZONTAL = Measure("horizontal", "horizontal error", "errors in the plan")
VERTICAL = Measure("vertical", "vertical error", "errors in height")
SPATIAL = Measure("spatial", "3-D error", "errors in space")
ROTATION = Measure("rotation", "rotation error", "errors of orientation", DEGREES)
