"""The similarity from a free network to control points, judged by what both sides' uncertainties allow."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.special import chdtrc

from app.geometry.rotation import exp_rotation
from app.geometry.similarity import Similarity, estimate_similarity
from app.geometry.target_map import Datum

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]

SIMILARITY_COUNT = 7
FIT_STEPS = 4  # the start is off by the points' noise; each step squares what is left


@dataclass(frozen=True)
class PointPairs:
    """Control points in both frames.

    Attributes
    ----------
    model_m : ndarray of shape (K, 3)
        Where the free network puts them.
    model_covariance : ndarray of shape (3 K, 3 K)
        Of those coordinates together.
    site_m : ndarray of shape (K, 3)
        Where the list puts them.
    sigma_m : ndarray of shape (K,)
        Of the list's coordinates.
    """

    model_m: Array
    model_covariance: Array
    site_m: Array
    sigma_m: Array

    def __len__(self) -> int:
        return len(self.model_m)

    def select(self, chosen: Index) -> PointPairs:
        """Some of the pairs."""
        coordinates = (3 * chosen[:, None] + np.arange(3)).ravel()
        covariance = self.model_covariance[np.ix_(coordinates, coordinates)]
        return PointPairs(self.model_m[chosen], covariance, self.site_m[chosen], self.sigma_m[chosen])

    def permuted(self, order: Index) -> PointPairs:
        """The same network points with the list's coordinates in another order."""
        return replace(self, site_m=self.site_m[order], sigma_m=self.sigma_m[order])


@dataclass(frozen=True)
class ControlFit:
    """A fitted similarity.

    Attributes
    ----------
    site_from_model : Similarity
    residuals_m : ndarray of shape (K, 3)
        Network's coordinates minus the list's, site frame.
    chi2 : float
        Weighted squares of the residuals.
    redundancy : int
        3 K - 7.
    """

    site_from_model: Similarity
    residuals_m: Array
    chi2: float
    redundancy: int

    def is_credible(self, doubt: float) -> bool:
        """Whether chance alone exceeds such residuals with more than a probability ``doubt``."""
        return bool(chdtrc(self.redundancy, self.chi2) > doubt)


def fit_control(pairs: PointPairs) -> ControlFit:
    """Similarity of least squares weighted by both sides' covariances.

    Raises
    ------
    DegenerateGeometry
        When the points stand in one line.
    """
    similarity = estimate_similarity(pairs.model_m, pairs.site_m)
    for _ in range(FIT_STEPS):
        origin_m = similarity.apply(pairs.model_m).mean(axis=0)
        design = Datum(origin_m, np.zeros((SIMILARITY_COUNT, SIMILARITY_COUNT))).point_jacobian(
            similarity.apply(pairs.model_m)
        )
        design = design.reshape(-1, SIMILARITY_COUNT)
        weighted = np.linalg.solve(_covariance(pairs, similarity), design)
        off = (pairs.site_m - similarity.apply(pairs.model_m)).ravel()
        step = np.asarray(np.linalg.solve(weighted.T @ design, weighted.T @ off), dtype=np.float64)
        similarity = _moved(similarity, origin_m, step)
    residuals = similarity.apply(pairs.model_m) - pairs.site_m
    chi2 = float(residuals.ravel() @ np.linalg.solve(_covariance(pairs, similarity), residuals.ravel()))
    return ControlFit(similarity, residuals, chi2, 3 * len(pairs) - SIMILARITY_COUNT)


def _covariance(pairs: PointPairs, similarity: Similarity) -> Array:
    """Of the differences between network and list, site frame, shape (3 K, 3 K)."""
    turned = np.kron(np.eye(len(pairs)), similarity.scale * similarity.rotation)
    return np.asarray(turned @ pairs.model_covariance @ turned.T + np.diag(np.repeat(pairs.sigma_m**2, 3)))


def _moved(similarity: Similarity, origin_m: Array, step: Array) -> Similarity:
    """The similarity after a small one about an origin: translation, rotation, log-scale."""
    growth, turn = float(np.exp(step[6])), exp_rotation(step[3:6])
    translation_m = growth * turn @ (similarity.translation_m - origin_m) + origin_m + step[:3]
    return Similarity(similarity.scale * growth, turn @ similarity.rotation, translation_m)
