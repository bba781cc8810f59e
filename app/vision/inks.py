"""From amplitudes to digits: which ink each identification dot is printed in, against this plate's own red and black.

Levels are read against the plate's base dots, with their gradient across the plate, so that exposure, white balance
and shading do not flip a digit. In linear light and in units of the red dots' red amplitude the printed inks stand at
(red, green) = black (0, 0), green (0, 0.5), white (1.5, 1.5), red (1, 0.01); a colour cast stretches the green axis,
over-exposure brings white down to (1, 1).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.targets.layout import BASE_CELLS, DIGIT_CELLS
from app.vision.homography import PLATE_DOTS_U
from app.vision.kernels.homographies import CORNER_DOT_U
from app.vision.kernels.inkwell import BLACK_DIGIT, HIDDEN_DIGIT, read_plates_inks

Array = npt.NDArray[np.float64]

BASE, DIGITS = list(BASE_CELLS), list(DIGIT_CELLS)


def level_from_base() -> Array:
    """Matrix, shape (16, 5), that extends five values at the base dots to all dots by their plane."""
    plane = np.column_stack([np.ones(len(PLATE_DOTS_U)), PLATE_DOTS_U / CORNER_DOT_U])
    result: Array = plane @ np.linalg.pinv(plane[BASE])
    return result


LEVEL_FROM_BASE = level_from_base()


@dataclass(frozen=True)
class InkOptions:
    """Where the inks part, in units of the plate's red amplitude.

    Attributes
    ----------
    base_red_min : float
        Red of a base dot over the median of the plate's five: what a shadow leaves; below, something covers it.
    base_off_red_max : float
        Green or blue of a base dot over its red: ink has 0.02, over-exposed ink 0.3, skin and wood 0.5 and more.
    white_red : float
        Half-way between green or black (0) and white (1-1.5) on the red axis.
    green_green : float
        Between black (0) and green (0.5, down to 0.3 in warm light) on the green axis.
    white_green_min : float
        White is at least this green; red (0, over-exposed 0.2) on an identification dot is no ink.
    white_max : float
        Brighter than any paper next to this red: a lamp. Chroma subsampling takes the red of dots of 4 px to a third,
        so that white stands at 5 there.
    dark_min : float
        Darker than the plate's black by this much: something covers the plate. Sharpening by the phone takes small
        black dots between white ones to -0.6.
    even_min : float
        Least over greatest red of the base dots of a plate in even light, or under a gradient that their plane takes
        up; noise brings plates of 2 to 3 px per u to 0.5. Below, an edge of shadow lies somewhere between them.
    white_over_green : float
        Red over green, and green over red, of a dot on such a plate: white has 1, green and red 0.01.
    base_green : float
        Green of red ink over its red; what more of it base dots show comes from their neighbours, by a blur or a
        sharpening that the template does not know.
    stray_aslant : float
        What a neighbour aslant gives of its light over what one beside gives.
    stray_unsure : float
        How far that light may be off, as part of it: neighbours across a shadow's edge are not alike.
    """

    base_red_min: float = 0.15
    base_off_red_max: float = 0.45
    white_red: float = 0.6
    green_green: float = 0.18
    white_green_min: float = 0.35
    white_max: float = 10.0
    dark_min: float = -1.5
    even_min: float = 0.4
    white_over_green: float = 0.5
    base_green: float = 0.01
    stray_aslant: float = 0.3
    stray_unsure: float = 0.3


@dataclass(frozen=True)
class InkReading:
    """What the dots of P plates show.

    Attributes
    ----------
    red_base : ndarray of shape (P, 5), bool
        Which base dots are red.
    digits : ndarray of shape (P, 11), int8
        2 white, 1 green, 0 black, -1 no ink of the plate (hidden).
    confidence : ndarray of shape (P, 11)
        Distance from the nearest border between two inks over the inks' own distance from it; 1 is typical.
    red_level : ndarray of shape (P, 16)
        Red amplitude expected at each dot.
    hidden, cut : ndarray of shape (P, 16), bool
        Dots that are known to be covered, so far that their ink, or their place, cannot be told.
    """

    red_base: npt.NDArray[np.bool_]
    digits: npt.NDArray[np.int8]
    confidence: Array
    red_level: Array
    hidden: npt.NDArray[np.bool_]
    cut: npt.NDArray[np.bool_]

    def behind(self, hidden: npt.NDArray[np.bool_], cut: npt.NDArray[np.bool_]) -> InkReading:
        """The same reading with dots that something covers, both of shape (P, 16)."""
        digits = np.where(hidden[:, DIGITS], np.int8(HIDDEN_DIGIT), self.digits)
        return replace(self, red_base=self.red_base & ~hidden[:, BASE], digits=digits, hidden=hidden, cut=cut)

    @property
    def coloured(self) -> npt.NDArray[np.bool_]:
        """Which of the sixteen dots show a printed colour and can be measured, shape (P, 16)."""
        coloured = np.empty(self.red_level.shape, dtype=np.bool_)
        coloured[:, BASE] = self.red_base
        coloured[:, DIGITS] = self.digits > BLACK_DIGIT
        return coloured & ~self.cut


def read_inks(amplitudes: Array, options: InkOptions = InkOptions()) -> InkReading:
    """Read plates whose dots have amplitudes of shape (P, 16, 3), blue, green, red."""
    count = len(amplitudes)
    reading = InkReading(
        red_base=np.empty((count, len(BASE)), dtype=np.bool_),
        digits=np.empty((count, len(DIGITS)), dtype=np.int8),
        confidence=np.empty((count, len(DIGITS))),
        red_level=np.empty((count, len(PLATE_DOTS_U))),
        hidden=np.zeros((count, len(PLATE_DOTS_U)), dtype=np.bool_),
        cut=np.zeros((count, len(PLATE_DOTS_U)), dtype=np.bool_),
    )
    written = (reading.red_base, reading.digits, reading.confidence, reading.red_level)
    bounds = tuple(vars(options).values())  # ``astuple`` copies deeply, at twenty times the price
    read_plates_inks(np.ascontiguousarray(amplitudes), LEVEL_FROM_BASE, bounds, written)
    return reading
