"""Accuracy of positions in the terms of ISO/IEC 18305:2016."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.trajectories.metrics.errors import Errors
from app.trajectories.metrics.summary import Summary, summarise
from app.trajectories.trajectory import Array


@dataclass(frozen=True)
class Accuracy:
    """How far the positions of a system are from the reference.

    Attributes
    ----------
    bias_m : ndarray of shape (3,)
        Mean of the error vector: what is systematic.
    rms_m : ndarray of shape (3,)
        Root mean square by axis.
    covariance_m2 : ndarray of shape (3, 3)
        Of the error vector about its mean (divided by the count less one); zeros for one pair.
    horizontal, vertical, spatial : Summary
        Of lengths in metres: their medians are CE50, VE50 and SE50, their ``quantile_95`` CE95, VE95 and SE95.
    rotation : Summary or None
        Of angles in radians; None without orientations.
    """

    bias_m: Array
    rms_m: Array
    covariance_m2: Array
    horizontal: Summary
    vertical: Summary
    spatial: Summary
    rotation: Summary | None


def accuracy_of(errors: Errors) -> Accuracy:
    """The accuracy that errors amount to; of one pair at least."""
    angles_rad = errors.angles_rad
    return Accuracy(
        bias_m=errors.vectors_m.mean(axis=0),
        rms_m=np.sqrt((errors.vectors_m**2).mean(axis=0)),
        covariance_m2=np.cov(errors.vectors_m.T) if len(errors) > 1 else np.zeros((3, 3)),
        horizontal=summarise(errors.horizontal_m),
        vertical=summarise(errors.vertical_m),
        spatial=summarise(errors.spatial_m),
        rotation=None if angles_rad is None else summarise(angles_rad),
    )
