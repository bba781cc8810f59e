"""One series of errors in few numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.trajectories.trajectory import Array

CIRCULAR = 0.5, 0.95  # the shares of CE50 and CE95
THIRD_QUARTILE = 0.75  # EvAAL's score


@dataclass(frozen=True)
class Summary:
    """Statistics of absolute errors, in their own unit.

    Attributes
    ----------
    count : int
    mean, rms, std, median, least, greatest : float
        ``std`` is that of the sample as it stands (divided by the count), as evaluation tools of robotics have it.
    sum_of_squares : float
    quantile_75, quantile_95 : float
        Of type 7 (Hyndman and Fan, The American Statistician 50(4), 1996), linear between order statistics.
    """

    count: int
    mean: float
    rms: float
    std: float
    median: float
    least: float
    greatest: float
    sum_of_squares: float
    quantile_75: float
    quantile_95: float


def summarise(values: Array) -> Summary:
    """Statistics of one or more values, shape (K,).

    Raises
    ------
    ValueError
        For no values at all: whoever asks knows what is missing.
    """
    if values.size == 0:
        raise ValueError("a summary takes one value at least")
    squares = float(values @ values)
    median, quantile_75, quantile_95 = np.quantile(values, [CIRCULAR[0], THIRD_QUARTILE, CIRCULAR[1]]).tolist()
    return Summary(
        count=values.size,
        mean=float(values.mean()),
        rms=float(np.sqrt(squares / values.size)),
        std=float(values.std()),
        median=median,
        least=float(values.min()),
        greatest=float(values.max()),
        sum_of_squares=squares,
        quantile_75=quantile_75,
        quantile_95=quantile_95,
    )
