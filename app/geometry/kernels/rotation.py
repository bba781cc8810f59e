"""Small rotations in compiled loops; ``app.geometry.rotation`` holds the same for arrays."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Array = npt.NDArray[np.float64]

SMALL_RAD = 1e-4  # under it the series to the fourth power is exact to the last bit


@compiled("void(float64[:, ::1], float64[:], float64[:, ::1])")
def turn_rotation(rotation: Array, turn_rad: Array, turned: Array) -> None:
    """A rotation turned from the left by a rotation vector (Rodrigues), written; proper to rounding, however often.

    One step of Newton's iteration R (3 I - R^T R) / 2 takes what rounding has left back to a rotation.
    """
    x, y, z = turn_rad[0], turn_rad[1], turn_rad[2]
    square = x * x + y * y + z * z
    angle = np.sqrt(square)
    if angle < SMALL_RAD:
        first, second = 1.0 - square / 6.0, 0.5 - square / 24.0
    else:
        first, second = np.sin(angle) / angle, (1.0 - np.cos(angle)) / square
    raw, inner = np.empty((3, 3)), np.empty((3, 3))
    for column in range(3):
        a, b, c = rotation[0, column], rotation[1, column], rotation[2, column]
        along = x * a + y * b + z * c
        raw[0, column] = a + first * (y * c - z * b) + second * (x * along - square * a)
        raw[1, column] = b + first * (z * a - x * c) + second * (y * along - square * b)
        raw[2, column] = c + first * (x * b - y * a) + second * (z * along - square * c)
    for row in range(3):
        for column in range(3):
            inner[row, column] = 1.5 if row == column else 0.0
            for axis in range(3):
                inner[row, column] -= 0.5 * raw[axis, row] * raw[axis, column]
    for row in range(3):
        for column in range(3):
            turned[row, column] = 0.0
            for axis in range(3):
                turned[row, column] += raw[row, axis] * inner[axis, column]
