"""Errors that the dots of one sighting share, taken out of its equations: ``PlateSigmas`` says how large they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.plate_sigmas import MODE_COUNT, PlateSigmas
from app.targets.layout import DOT_COUNT, dot_centres_u

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class PlateModes:
    """The shared errors of M sightings.

    Attributes
    ----------
    basis : ndarray of shape (M, 32, 6)
        Orthonormal columns over the whitened coordinates of the sixteen dots: shifts, then linear deformations.
    sigmas : PlateSigmas
    """

    basis: Array
    sigmas: PlateSigmas

    def select(self, chosen: npt.NDArray[np.bool_] | npt.NDArray[np.intp] | slice) -> PlateModes:
        """Of some of the sightings."""
        return PlateModes(self.basis[chosen], self.sigmas)

    def decorrelate(self, rows: Array) -> Array:
        """Whitened rows, shape (M, 16, 2, k), turned into uncorrelated ones of unit variance."""
        flat = rows.reshape(len(rows), 2 * DOT_COUNT, -1)
        modes = np.swapaxes(self.basis, -1, -2) @ flat
        factors = 1.0 / self.sigmas.of_modes - 1.0 / self.sigmas.dots
        return (flat / self.sigmas.dots + self.basis @ (factors[:, None] * modes)).reshape(rows.shape)


def plate_basis(whitening_per_px: Array) -> Array:
    """Orthonormal modes, shape (M, 32, 6), of sightings whose dots are whitened by (M, 16, 2, 2).

    Notes
    -----
    By QR of the whitened shifts and linear deformations. Dots that were not measured have zero rows; the columns of a
    sighting whose dots do not span all modes are still orthonormal where they are not zero.
    """
    shapes = np.concatenate([np.ones((DOT_COUNT, 1)), dot_centres_u()], axis=1)  # 1, x, y over the plate
    columns = whitening_per_px[:, :, :, None, :] * shapes[:, None, :, None]
    return np.asarray(np.linalg.qr(columns.reshape(len(whitening_per_px), 2 * DOT_COUNT, MODE_COUNT)).Q)
