"""Whether the errors say something of the system, or no more than the reference's own uncertainty."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri  # scipy.stats has the same and takes a third of a second to be imported

from app.trajectories.metrics.errors import Errors

CONFIDENCE = 0.95
FREEDOMS = 3  # of a position


@dataclass(frozen=True)
class Verdict:
    """Errors beside the reference's uncertainty.

    Attributes
    ----------
    expected_rms_m : float
        3-D RMS that a system without any error would show against this reference.
    measured_rms_m : float
    system_rms_m : float or None
        What is left for the system when the reference's part is taken out; None when nothing is left.
    indistinct_share : float
        Share of the pairs whose error lies within the reference's 95 % ellipsoid.
    distinguishable : bool
        Whether the errors as a whole exceed what the reference alone explains (one-sided, 5 %).
    """

    expected_rms_m: float
    measured_rms_m: float
    system_rms_m: float | None
    indistinct_share: float
    distinguishable: bool

    @property
    def sentence(self) -> str:
        """For people."""
        if self.distinguishable:
            return (
                f"the error of {self.measured_rms_m:.4f} m exceeds the reference's own uncertainty "
                f"of {self.expected_rms_m:.4f} m"
            )
        return (
            f"the error of {self.measured_rms_m:.4f} m cannot be told from the reference's own uncertainty "
            f"of {self.expected_rms_m:.4f} m: nothing is known of the system but that it is no worse"
        )


def verdict_on(errors: Errors) -> Verdict | None:
    """The verdict; None when the reference told no covariances.

    Notes
    -----
    Under the hypothesis of a perfect system every error is drawn from the reference's covariance C, so that
    ``e^T C^-1 e`` follows chi-square with 3 degrees of freedom. The poses of a site share the part of C that is its
    datum, so the sum over pairs is judged as if they were all one draw: its mean against the quantile of a single one.
    That is the cautious choice: errors are distinguishable only when a wholly shared uncertainty cannot explain them.
    """
    covariances_m2 = errors.reference_covariances_m2
    if covariances_m2 is None:
        return None
    squared = _normalised_squares(errors)
    expected_m2 = float(np.trace(covariances_m2, axis1=1, axis2=2).mean())
    measured_m2 = float((errors.vectors_m**2).sum(axis=1).mean())
    limit = float(chdtri(FREEDOMS, 1.0 - CONFIDENCE))
    return Verdict(
        expected_rms_m=float(np.sqrt(expected_m2)),
        measured_rms_m=float(np.sqrt(measured_m2)),
        system_rms_m=float(np.sqrt(measured_m2 - expected_m2)) if measured_m2 > expected_m2 else None,
        indistinct_share=float((squared <= limit).mean()),
        distinguishable=bool(squared.mean() > limit),
    )


def _normalised_squares(errors: Errors) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """``e^T C^-1 e`` of each pair, shape (K,); infinite where the reference claims to know a direction exactly."""
    assert errors.reference_covariances_m2 is not None
    values, axes = np.linalg.eigh(errors.reference_covariances_m2)
    along = np.einsum("kij,ki->kj", axes, errors.vectors_m) ** 2
    known = values > np.finfo(np.float64).eps * np.abs(values).max(axis=1, keepdims=True)
    terms = np.divide(along, values, out=np.where(along > 0, np.inf, 0.0), where=known)
    return terms.sum(axis=1)
