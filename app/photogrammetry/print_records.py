"""What the report says of the print batches: how large each one was printed, and whose bars should be measured."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.photogrammetry.prints import PRINT_COUNT
from app.photogrammetry.survey_solution import Solution

Array = npt.NDArray[np.float64]


def print_scales(solution: Solution) -> tuple[Array, Array]:
    """Printed over nominal length of each batch, shape (B, 2), and their variances; zero where a scale is held."""
    prints = solution.problem.prints
    scale = prints.expected + prints.off(solution.network.print_scale)
    variances = np.zeros(PRINT_COUNT * prints.count)
    free = int(prints.free.sum())
    variances[prints.free] = np.diag(solution.border_covariance)[len(solution.border_covariance) - free :]
    return scale, variances.reshape(-1, PRINT_COUNT)
