"""Whether plates are of two sizes rather than of one, when no single plate shows it: a mixture of two print scales.

Source: Dempster, Laird and Rubin, Maximum likelihood from incomplete data via the EM algorithm, JRSS B 39, 1977. Both
hypotheses may scatter as widely as suits them, so that plates which merely scatter do not make two sizes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

AXES = 2


@dataclass(frozen=True)
class TwoSizesOptions:
    """When two sizes are believed.

    Attributes
    ----------
    scatters : tuple of float
        Relative scatters of the prints of one size that are tried.
    rounds : int
        Of the EM algorithm; sizes that are apart are found in ten.
    least_gain : float
        Twice the logarithm of the likelihoods' ratio: chance exceeds 40 with three parameters more once in 1e8.
    """

    scatters: tuple[float, ...] = (0.0, 0.0005, 0.001, 0.002, 0.004)
    rounds: int = 30
    least_gain: float = 40.0


@dataclass(frozen=True)
class TwoSizes:
    """The two scales, shape (2, 2), the larger group first, and which plates (T,) are rather of the second."""

    centres: Array
    second: Mask


def two_sizes(values: Array, covariances: Array, options: TwoSizesOptions) -> TwoSizes | None:
    """Two sizes of plates with scales (T, 2) of covariances (T, 2, 2); None where one explains them as well."""
    best_one, best_two, found = -np.inf, -np.inf, None
    for scatter in options.scatters:
        widened = covariances + scatter**2 * np.eye(AXES)
        best_one = max(best_one, _Component.of(values, widened, np.ones(len(values))).log_likelihoods.sum())
        likelihood, sizes = _mixture(values, widened, options.rounds)
        if likelihood > best_two:
            best_two, found = likelihood, sizes
    return found if 2.0 * (best_two - best_one) > options.least_gain else None


@dataclass(frozen=True)
class _Component:
    """A size, and the logarithm of each plate's likelihood under it, shape (T,)."""

    centre: Array
    log_likelihoods: Array

    @classmethod
    def of(cls, values: Array, covariances: Array, weights: Array) -> _Component:
        """The size of weighted plates."""
        information = np.linalg.inv(covariances)
        total = (weights[:, None, None] * information).sum(axis=0)
        right = (weights[:, None, None] * information @ values[..., None]).sum(axis=0)
        centre = np.linalg.solve(total, right)[:, 0]
        off = values - centre
        squared = np.einsum("ti,tij,tj->t", off, information, off)
        return cls(centre, 0.5 * (np.linalg.slogdet(information)[1] - squared) - np.log(2.0 * np.pi))


def _mixture(values: Array, covariances: Array, rounds: int) -> tuple[float, TwoSizes]:
    """Log-likelihood of two sizes, and these; it starts from the plates above and below the middle size."""
    middle = values.mean(axis=-1)
    of_second = (middle < np.median(middle)).astype(np.float64)
    for _ in range(rounds):
        share = np.clip(of_second.mean(), 1.0 / len(values), 1.0 - 1.0 / len(values))
        first = _Component.of(values, covariances, np.maximum(1.0 - of_second, np.finfo(np.float64).tiny))
        second = _Component.of(values, covariances, np.maximum(of_second, np.finfo(np.float64).tiny))
        each = np.stack([np.log(1.0 - share) + first.log_likelihoods, np.log(share) + second.log_likelihoods])
        whole = np.logaddexp(*each)
        of_second = np.exp(each[1] - whole)
    centres, chosen = np.stack([first.centre, second.centre]), of_second > 0.5
    if chosen.mean() > 0.5:
        centres, chosen = centres[::-1], ~chosen
    return float(whole.sum()), TwoSizes(centres, chosen)
