"""The plate: sixteen dot positions in the module u, and which cells carry what.

Lengths are in u; the target frame has its origin at the plate's centre, x to the right, y up, z towards the viewer.
Source: Sensors 2019 (robust visual encoded targets), section 3.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

PLATE_SIDE_U = 13.0
DOT_PITCH_U = 3.0
DOT_RADIUS_U = 1.0
EDGE_TO_DOT_U = 2.0
DEFAULT_U_M = 0.014

CELLS_PER_SIDE = 4
DOT_COUNT = CELLS_PER_SIDE**2

# Cell indices are row-major: cell = 4 * row + column, row 0 on top, as seen from the front.
BASE_CELLS: tuple[int, ...] = (0, 3, 15, 12, 5)  # A, B, C, D, E
BASE_NAMES = "ABCDE"
DIGIT_CELLS: tuple[int, ...] = tuple(cell for cell in range(DOT_COUNT) if cell not in BASE_CELLS)  # d0 ... d10


def dot_centres_u() -> npt.NDArray[np.float64]:
    """Dot centres in the target frame, shape (16, 2), in u, row-major cells."""
    row, column = np.divmod(np.arange(DOT_COUNT), CELLS_PER_SIDE)
    return np.stack([DOT_PITCH_U * column - 4.5, -(DOT_PITCH_U * row - 4.5)], axis=1)


def dots_from_corner_u() -> npt.NDArray[np.float64]:
    """Dot centres from the plate's top left corner, x to the right, y down, shape (16, 2), in u, row-major cells."""
    return dot_centres_u() * [1.0, -1.0] + PLATE_SIDE_U / 2


def dots_target_m(u_m: float, scale_xy: tuple[float, float] = (1.0, 1.0)) -> npt.NDArray[np.float64]:
    """Dot centres in the target frame, shape (16, 3), in metres.

    Parameters
    ----------
    u_m : float
        Nominal module.
    scale_xy : tuple of float
        Print scale along (x) and across (y) the plate: printed length over nominal length.
    """
    return np.column_stack([dot_centres_u() * u_m * np.asarray(scale_xy), np.zeros(DOT_COUNT)])


def cell_of_dot(name: str) -> int | None:
    """Row-major cell of a dot named ``A`` ... ``E`` or ``r<row>c<column>``; None for ``centre``, the plate's middle.

    Raises
    ------
    ValueError
        For any other name.
    """
    if name == "centre":
        return None
    if len(name) == 1 and name in BASE_NAMES:
        return BASE_CELLS[BASE_NAMES.index(name)]
    if len(name) == 4 and name[0] == "r" and name[2] == "c" and name[1] in "0123" and name[3] in "0123":
        return CELLS_PER_SIDE * int(name[1]) + int(name[3])
    raise ValueError(f"dot {name!r} is none of A ... E, r0c0 ... r3c3, centre")
