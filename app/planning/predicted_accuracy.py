"""How far a position that is not measured yet can be trusted: the covariance of the resection's own normal equations.

Nothing is estimated from observations: the matrix of the collinearity equations at the pose, with the uncertainty of
dots, of each target, of the camera and of the datum, is inverted. A resection reaches that bound within a few percent
(``python -m benchmarks.coverage``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_COUNT
from app.geometry.target_map import Datum
from app.photogrammetry.resection_adjustment import evaluate
from app.photogrammetry.resection_equations import POSE_COUNT, STATE_COUNT, CameraPrior, State
from app.planning.predicted_views import PredictedViews

Array = npt.NDArray[np.float64]

NORMAL_95 = 1.6448536269514722  # 95 % of a normal distribution lie below so many standard deviations


@dataclass(frozen=True)
class Information:
    """What views know of pose and camera: normal matrices (V, 15, 15) without any prior, and targets in view (V,)."""

    matrices: Array
    targets: npt.NDArray[np.intp]


def information_of(views: PredictedViews, prior: CameraPrior) -> Information:
    """Normal matrices of views, the camera's prior left out so that those of parts can be added."""
    counts = np.diff(views.starts)
    matrices = np.zeros((len(views.poses), STATE_COUNT, STATE_COUNT))
    seeing = np.flatnonzero(counts)
    if len(seeing):
        matrices[seeing] = np.add.reduceat(sighting_information(views, prior), views.starts[seeing], axis=0)
    return Information(matrices, counts)


def sighting_information(views: PredictedViews, prior: CameraPrior) -> Array:
    """What each sighting adds to the normal matrix of its view, its target's own errors eliminated, (N, 15, 15)."""
    matrices = np.empty((len(views.target), STATE_COUNT, STATE_COUNT))
    for view in np.flatnonzero(np.diff(views.starts)).tolist():
        at = evaluate(views.of(view), prior, State(views.poses[view], np.zeros(INTRINSIC_COUNT)))
        matrices[views.starts[view] : views.starts[view + 1]] = at.equations.information
    return matrices


def position_covariances(matrices: Array, datum_covariance: Array) -> Array:
    """Covariances of positions, shape (V, 3, 3), m^2, of normal matrices (V, 15, 15) without the camera's prior.

    Parameters
    ----------
    matrices : ndarray of shape (V, 15, 15)
        Of views that see enough to be located.
    datum_covariance : ndarray of shape (3, 3) or (V, 3, 3)
        What the map's datum adds to a position.
    """
    with_prior = matrices + np.diag(np.r_[np.zeros(POSE_COUNT), np.ones(INTRINSIC_COUNT)])
    # In units of each unknown's own diagonal: metres and radians differ by orders of magnitude.
    scale = 1.0 / np.sqrt(np.diagonal(with_prior, axis1=1, axis2=2))
    inverse = np.linalg.inv(with_prior * scale[:, :, None] * scale[:, None, :]) * scale[:, :, None] * scale[:, None, :]
    return np.asarray(inverse[:, :3, :3] + datum_covariance)


def datum_covariances(datum: Datum, positions_m: Array) -> Array:
    """What a datum adds to positions of shape (P, 3), shape (P, 3, 3): the shared part, propagated once."""
    jacobian = datum.point_jacobian(positions_m)
    return np.asarray(jacobian @ datum.covariance @ np.swapaxes(jacobian, -1, -2))


def radius95(covariances_m2: Array) -> Array:
    """Radius that holds 95 % of positions with covariances (..., 3, 3), in 3-D, shape (...,), m.

    Notes
    -----
    The squared distance is a weighted sum of three chi-squares; a scaled one with the same mean and variance stands for
    it (Satterthwaite, Biometrics Bulletin 2, 1946), and its quantile by Wilson and Hilferty (PNAS 17, 1931): together
    within 2 % of the true radius whatever the ellipsoid's shape.
    """
    mean = np.trace(covariances_m2, axis1=-2, axis2=-1)
    squares = (covariances_m2**2).sum(axis=(-2, -1))
    freedom = mean**2 / squares
    spread = 2.0 / (9.0 * freedom)
    return np.asarray(np.sqrt(mean * (1.0 - spread + NORMAL_95 * np.sqrt(spread)) ** 3))
