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
LEAST = 1e-3  # of an axis, also where there is no error at all: a millimetre, a thousandth of a degree


@dataclass(frozen=True)
class Reach:
    """The end of an axis of errors.

    Attributes
    ----------
    end : float
        In the unit of the errors, as ``greatest``.
    beyond : int
        Errors that are greater.
    greatest : float
    """

    end: float
    beyond: int
    greatest: float

    def said_of(self, words: str, unit: str = "m") -> str:
        """The sentence for a caption, of errors in such words; nothing when the axis shows all."""
        if self.beyond == 0:
            return ""
        verb = "lies" if self.beyond == 1 else "lie"
        greatest = error_m(self.greatest)
        return f" {count(self.beyond)} of the {words} {verb} beyond the axis, the greatest at {greatest} {unit}."


def reach_of(series: Sequence[Array]) -> Reach:
    """The axis for sizes of errors, of shape (K,) each, none empty."""
    greatest = max(float(sizes.max()) for sizes in series)
    usual = max(float(np.quantile(sizes, USUAL)) for sizes in series)
    far = greatest > FAR * usual > 0.0
    end = max(BEYOND_USUAL * usual if far else ROOM * greatest, LEAST)
    beyond = sum(int((sizes > end).sum()) for sizes in series)
    return Reach(end, beyond, greatest)
