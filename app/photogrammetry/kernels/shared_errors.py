"""Errors that the dots of one sighting share, in the products of its equations (``PlateSigmas``)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

MODES, SHIFTS = 6, 2  # two of shift, then four linear
COORDINATES = 2 * DOT_COUNT
# A mode that the measured dots do not tell from those before it, by what is left of its length.
LEAST_LENGTH = float(np.sqrt(np.finfo(np.float64).eps))


@compiled("boolean(float64[:, :, :, ::1], boolean[:, ::1], float64[:, :, ::1])")
def whiten_dots(covariances_px2: Array, measured: Mask, whiteners: Array) -> bool:
    """Inverse Cholesky factors of the dots' covariances, written; False when one is not finite and positive definite.

    Parameters
    ----------
    covariances_px2 : ndarray of shape (K, 16, 2, 2)
    measured : ndarray of shape (K, 16), bool
    whiteners : ndarray of shape (K, 16, 3)
        Elements (0, 0), (1, 0), (1, 1); zero where not measured.
    """
    whiteners[:] = 0.0
    for sighting in range(len(measured)):
        for dot in range(DOT_COUNT):
            if not measured[sighting, dot]:
                continue
            xx, xy, yy = (
                covariances_px2[sighting, dot, 0, 0],
                covariances_px2[sighting, dot, 0, 1],
                covariances_px2[sighting, dot, 1, 1],
            )
            rest = yy - xy * xy / xx
            if not (0.0 < xx < np.inf and 0.0 < rest < np.inf):
                return False
            whitener = whiteners[sighting, dot]
            whitener[0], whitener[2] = 1.0 / np.sqrt(xx), 1.0 / np.sqrt(rest)
            whitener[1] = -xy / xx * whitener[2]
    return True


@compiled("float64(float64[::1], float64[::1])")
def _product(one: Array, other: Array) -> float:
    total = 0.0
    for place in range(COORDINATES):
        total += one[place] * other[place]
    return total


@compiled("void(float64[:, ::1], int64)")
def _take_out_earlier(basis: Array, mode: int) -> None:
    """Make a mode orthogonal to those before it (Gram and Schmidt) and of unit length, or zero."""
    own = basis[mode]
    before = _product(own, own)
    for earlier in range(mode):
        shared = _product(own, basis[earlier])
        for place in range(COORDINATES):
            own[place] -= shared * basis[earlier, place]
    after = _product(own, own)
    scale = 1.0 / np.sqrt(after) if after > LEAST_LENGTH * before else 0.0
    for place in range(COORDINATES):
        own[place] *= scale


@compiled("void(float64[:, :, ::1], float64[:, ::1], float64[:, :, ::1])")
def find_modes(whiteners: Array, shapes: Array, modes: Array) -> None:
    """Orthonormal modes, (K, 6, 32), written, of sightings whose dots are whitened: shifts, then linear deformations.

    Parameters
    ----------
    whiteners : ndarray of shape (K, 16, 3)
        Elements (0, 0), (1, 0), (1, 1) of each dot's; zero where it was not measured.
    shapes : ndarray of shape (16, 3)
        1, x, y over the plate.
    """
    for sighting in range(len(whiteners)):
        basis = modes[sighting]
        for dot in range(DOT_COUNT):
            upper, mixed, lower = whiteners[sighting, dot]
            for shape in range(MODES // 2):  # along x, then along y
                size = shapes[dot, shape]
                basis[2 * shape, 2 * dot], basis[2 * shape, 2 * dot + 1] = size * upper, size * mixed
                basis[2 * shape + 1, 2 * dot], basis[2 * shape + 1, 2 * dot + 1] = 0.0, size * lower
        for mode in range(MODES):
            _take_out_earlier(basis, mode)


@compiled("void(float64[:, ::1], float64[:, ::1], float64[::1], float64[:, ::1])")
def weigh_shared(rows: Array, modes: Array, sigmas: Array, gram: Array) -> None:
    """Products of whitened rows under errors that are shared, in place of those under independent ones.

    The covariance of the whitened coordinates is d^2 I + B (s^2 - d^2) B^T with the modes B and their sigmas s; so its
    inverse is I / d^2 + B (1 / s^2 - 1 / d^2) B^T.

    Parameters
    ----------
    rows : ndarray of shape (32, N)
    modes : ndarray of shape (6, 32)
    sigmas : ndarray of shape (3,)
        Of shift, linear deformation, single dots.
    gram : ndarray of shape (N, N)
        In: rows^T rows.
    """
    columns = rows.shape[1]
    of_dots = 1.0 / sigmas[2] ** 2
    of_modes = np.zeros((MODES, columns))
    for mode in range(MODES):
        line = of_modes[mode]
        for row in range(0, COORDINATES, 4):  # four at a time: each sum is loaded and stored once for them
            a, b, c, d = modes[mode, row : row + 4]
            for column in range(columns):
                line[column] += (
                    a * rows[row, column]
                    + b * rows[row + 1, column]
                    + c * rows[row + 2, column]
                    + d * rows[row + 3, column]
                )
    shift, linear = 1.0 / sigmas[0] ** 2 - of_dots, 1.0 / sigmas[1] ** 2 - of_dots
    for row in range(columns):
        a, b = shift * of_modes[0, row], shift * of_modes[1, row]
        c, d, e, f = linear * of_modes[2:, row]
        for column in range(columns):
            gram[row, column] = (
                of_dots * gram[row, column]
                + (a * of_modes[0, column] + b * of_modes[1, column])
                + (c * of_modes[2, column] + d * of_modes[3, column])
                + (e * of_modes[4, column] + f * of_modes[5, column])
            )
