"""How far an axis of errors goes: to the greatest, unless that would press all others together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.numbers import error_m
from app.services.reporting.numbers import count

Array = npt.NDArray[np.float64]

USUAL = 0.95  # share of the errors of each system that an axis shows in any case
FAR = 4.0  # the greatest error is shown up to so many times the usual ones
BEYOND_USUAL = 1.5  # how far an axis goes that does not show it
ROOM = 1.04
LEAST_M = 1e-3  # of an axis, also where there is no error at all


@dataclass(frozen=True)
class Reach:
    """The end of an axis of errors.

    Attributes
    ----------
    end_m : float
    beyond : int
        Errors that are greater.
    greatest_m : float
    """

    end_m: float
    beyond: int
    greatest_m: float

    def said_of(self, words: str) -> str:
        """The sentence for a caption, of errors in such words; nothing when the axis shows all."""
        if self.beyond == 0:
            return ""
        verb = "lies" if self.beyond == 1 else "lie"
        greatest = error_m(self.greatest_m)
        return f" {count(self.beyond)} of the {words} {verb} beyond the axis, the greatest at {greatest} m."


def reach_of(series_m: Sequence[Array]) -> Reach:
    """The axis for sizes of errors, of shape (K,) each, none empty."""
    greatest_m = max(float(series.max()) for series in series_m)
    usual_m = max(float(np.quantile(series, USUAL)) for series in series_m)
    far = greatest_m > FAR * usual_m > 0.0
    end_m = max(BEYOND_USUAL * usual_m if far else ROOM * greatest_m, LEAST_M)
    beyond = sum(int((series > end_m).sum()) for series in series_m)
    return Reach(end_m, beyond, greatest_m)
