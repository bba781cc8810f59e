"""The three sizes of an error that figures show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.trajectories.evaluation import Evaluation

Array = npt.NDArray[np.float64]
Part = Literal["horizontal", "vertical", "spatial"]


@dataclass(frozen=True)
class Measure:
    """A size of errors: which part of them, how an axis and how a sentence names it."""

    part: Part
    title: str
    words: str

    def of(self, evaluation: Evaluation) -> Array:
        """Sizes in metres, shape (K,)."""
        errors = evaluation.errors
        if self.part == "horizontal":
            return errors.horizontal_m
        return errors.vertical_m if self.part == "vertical" else errors.spatial_m


HORIZONTAL = Measure("horizontal", "horizontal error, m", "errors in the plan")
VERTICAL = Measure("vertical", "vertical error, m", "errors in height")
SPATIAL = Measure("spatial", "3-D error, m", "errors in space")
