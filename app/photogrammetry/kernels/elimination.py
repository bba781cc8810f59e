"""A target's own unknowns out of the products of its equations, the photograph's in: pose and whitened camera."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.geometry.kernels.general import solve_general
from app.photogrammetry.kernels.layout import COLUMNS, INTRINSICS, OWN

Array = npt.NDArray[np.float64]


@compiled("void(float64[:, ::1], float64[:, ::1], Tuple((float64[:, ::1], float64[:, ::1])))")
def _find_gain(gram: Array, own_covariance: Array, room: tuple[Array, Array]) -> None:
    """(Q^-1 + N)^-1 of a target's own covariance Q, written to the front of the room; Q may be zero: no inverse."""
    gain, mixed = room
    for row in range(OWN):
        for column in range(OWN):
            gain[row, column] = own_covariance[row, column]
            mixed[row, column] = 1.0 if row == column else 0.0
            for inner in range(OWN):
                mixed[row, column] += own_covariance[row, inner] * gram[inner, column]
    solve_general(mixed, gain)


@compiled("void(float64[:, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def _take_out(gram: Array, gain: Array, gained: Array, reduced: Array) -> None:
    """Schur complement, written: ``reduced = gram - own^T gain own`` with the own rows of the products."""
    for row in range(OWN):
        line = gained[row]
        a, b, c, d, e, f = gain[row]
        for column in range(COLUMNS):
            line[column] = (
                (a * gram[0, column] + b * gram[1, column])
                + (c * gram[2, column] + d * gram[3, column])
                + (e * gram[4, column] + f * gram[5, column])
            )
    for row in range(COLUMNS):
        line = reduced[row]
        a, b, c, d, e, f = gram[row, :OWN]
        for column in range(row - row % 4, COLUMNS):  # whole registers
            line[column] = gram[row, column] - (
                (a * gained[0, column] + b * gained[1, column])
                + (c * gained[2, column] + d * gained[3, column])
                + (e * gained[4, column] + f * gained[5, column])
            )
        for column in range(row):
            line[column] = reduced[column, row]


@compiled("void(float64[:, ::1], float64[::1])")
def _to_pose(reduced: Array, to_centre_m: Array) -> None:
    """Put the camera's movement, which is the target's the other way, in the place of the target's.

    Moving and turning the camera by (t, r) moves the target by ``centre x r - t`` and turns it by ``-r``.
    """
    x, y, z = to_centre_m
    for column in range(COLUMNS):
        a, b, c = reduced[0, column], reduced[1, column], reduced[2, column]
        reduced[0, column], reduced[1, column], reduced[2, column] = -a, -b, -c
        reduced[3, column] = z * b - y * c - reduced[3, column]
        reduced[4, column] = x * c - z * a - reduced[4, column]
        reduced[5, column] = y * a - x * b - reduced[5, column]
    for row in range(COLUMNS):
        line = reduced[row]
        a, b, c = line[0], line[1], line[2]
        line[0], line[1], line[2] = -a, -b, -c
        line[3] = z * b - y * c - line[3]
        line[4] = x * c - z * a - line[4]
        line[5] = y * a - x * b - line[5]


@compiled("void(float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def _whiten_camera(reduced: Array, root: Array, mixed: Array) -> None:
    """Put the intrinsics in units of their prior, ``root @ z``, in the place of the intrinsics."""
    for row in range(INTRINSICS):
        line = mixed[row]
        line[:] = 0.0
        for inner in range(0, INTRINSICS, 3):
            a, b, c = root[inner, row], root[inner + 1, row], root[inner + 2, row]
            for column in range(COLUMNS):
                line[column] += (
                    a * reduced[OWN + inner, column]
                    + b * reduced[OWN + inner + 1, column]
                    + c * reduced[OWN + inner + 2, column]
                )
    for row in range(INTRINSICS):
        for column in range(COLUMNS):
            reduced[OWN + row, column] = mixed[row, column]
            reduced[column, OWN + row] = mixed[row, column]
    for row in range(INTRINSICS):
        line = reduced[OWN + row]
        line[OWN : OWN + INTRINSICS] = 0.0
        for inner in range(0, INTRINSICS, 3):
            a, b, c = mixed[row, OWN + inner], mixed[row, OWN + inner + 1], mixed[row, OWN + inner + 2]
            for column in range(INTRINSICS):
                line[OWN + column] += (
                    a * root[inner, column] + b * root[inner + 1, column] + c * root[inner + 2, column]
                )


@compiled(
    "void(float64[:, ::1], Tuple((float64[:, ::1], float64[::1], float64[:, ::1])), "
    "Tuple((float64[:, ::1], float64[:, ::1], float64[:, ::1])), float64[:, ::1])"
)
def eliminate_own(gram: Array, changes: tuple[Array, ...], room: tuple[Array, ...], reduced: Array) -> None:
    """Products (16, 16) of pose, whitened camera and residual, written.

    Parameters
    ----------
    gram : ndarray of shape (16, 16)
        Products of a target's own movement, intrinsics and residual.
    changes : tuple of ndarray
        The target's own covariance (6, 6), its centre from the camera (3,) in site axes, and the root of the
        intrinsics' prior covariance (9, 9).
    room : tuple of ndarray
        (6, 6), (6, 6) and (9, 16), written.
    """
    own_covariance, to_centre_m, root = changes
    gain, inner, mixed = room
    _find_gain(gram, own_covariance, (gain, inner))
    _take_out(gram, gain, mixed, reduced)
    _to_pose(reduced, to_centre_m)
    _whiten_camera(reduced, root, mixed)
