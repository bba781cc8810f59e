"""Template fits of many plates, each under the template for its own blur."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.coefficients import CHANNELS, COEFFICIENTS, solve_plate, sort_coefficients, unexplained
from app.vision.kernels.projection import TEMPLATE, Template, project_plate, whole_steps

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Indices = npt.NDArray[np.int64]


@compiled(
    f"void(float32[:, :, ::1], int64[:, ::1], {TEMPLATE}, UniTuple(float64, 2), Tuple((float64[:, :, ::1], "
    "float64[:, :, :, ::1], float64[:, :, ::1], float64[::1], float64[::1], float64[:, :, :, ::1])))"
)
def fit_plates(
    samples: Array32, orders: Indices, template: Template, paper: tuple[float, float], fits: tuple[Array, ...]
) -> None:
    """Fit N times a plate.

    Parameters
    ----------
    samples : ndarray of shape (P, 3, S), float32
    orders : ndarray of shape (3, N)
        Of each fit the plate, the level of its template, and the row that is written.
    template : tuple of ndarray
        The fields of ``TemplateShelf``, in their order.
    paper : tuple of float
        The ridge on the paper's coefficients; how far a patch reaches, u.
    fits : tuple of ndarray, written
        Of ``PlateFits`` amplitudes, slopes, planes, residual_rms, spread_rms, offset_cofactors.
    """
    amplitudes, slopes, planes, residual_rms, spread_rms, offset_cofactors = fits
    right, solved = np.empty((CHANNELS, COEFFICIENTS)), np.empty((CHANNELS, COEFFICIENTS))
    parts = np.zeros((CHANNELS, whole_steps(samples.shape[2])), dtype=np.float32)
    # Level by level: a template then stays in the processor's nearest cache for all of its plates.
    for fit in np.argsort(orders[1]):
        plate, level, row = orders[0, fit], orders[1, fit], orders[2, fit]
        project_plate(samples[plate], template, level, parts, right)
        solve_plate(right, template[3][level], solved)
        residual_rms[row], spread_rms[row] = unexplained(samples[plate], right, solved, paper[0])
        sort_coefficients(solved, paper[1], amplitudes[row], slopes[row], planes[row])
        offset_cofactors[row] = template[4][level]
