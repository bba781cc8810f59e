"""A similarity takes points of one frame to another: the step from the survey's free network to the site frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import DegenerateGeometry

Points = npt.NDArray[np.float64]  # (N, 3), metres


@dataclass(frozen=True)
class Similarity:
    """Seven parameters ``target_from_source``: ``target = scale * rotation @ source + translation_m``.

    Attributes
    ----------
    scale : float
        Target units per source unit, positive.
    rotation : ndarray of shape (3, 3)
        Proper rotation.
    translation_m : ndarray of shape (3,)
        Where the source's origin stands in the target frame.
    """

    scale: float
    rotation: npt.NDArray[np.float64]
    translation_m: npt.NDArray[np.float64]

    def __post_init__(self) -> None:
        if not self.scale > 0:
            raise ValueError(f"scale must be positive, got {self.scale}")
        if abs(np.linalg.det(self.rotation) - 1.0) > 1e-6:
            raise ValueError("rotation must be proper (determinant 1)")

    def apply(self, source_m: Points) -> Points:
        """Take points of shape (N, 3) from the source to the target frame."""
        return self.scale * source_m @ self.rotation.T + self.translation_m

    def inverse(self) -> Similarity:
        """The same relation read the other way: ``source_from_target``."""
        source_from_target = self.rotation.T / self.scale
        return Similarity(1.0 / self.scale, self.rotation.T, -source_from_target @ self.translation_m)


def estimate_similarity(source_m: Points, target_m: Points, *, scale_is_free: bool = True) -> Similarity:
    """Least-squares similarity of paired points; with ``scale_is_free=False`` the rigid motion, of scale 1.

    Parameters
    ----------
    source_m, target_m : ndarray of shape (N, 3)
        The same N >= 3 points in both frames, not on one line.

    Raises
    ------
    DegenerateGeometry
        When the points fix no rotation: name a control point off the line.

    Notes
    -----
    Umeyama, IEEE PAMI 13(4), 1991, equations 34-43. Exact for noise-free points, which the tests use as their law.
    """
    source_mean_m, target_mean_m = source_m.mean(axis=0), target_m.mean(axis=0)
    source_centred, target_centred = source_m - source_mean_m, target_m - target_mean_m
    u, singular, vt = np.linalg.svd(target_centred.T @ source_centred / len(source_m))  # eq. 38
    # Two independent directions fix a rotation; the third follows from handedness.
    if singular[1] < 1e-9 * singular[0]:
        raise DegenerateGeometry("control points lie on one line; add a control point off that line")
    handedness = np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))])  # eq. 39
    rotation = u * handedness @ vt  # eq. 40
    free_scale = float(singular @ handedness / (source_centred**2).sum(axis=1).mean())  # eq. 42
    scale = free_scale if scale_is_free else 1.0
    return Similarity(scale, rotation, target_mean_m - scale * rotation @ source_mean_m)  # eq. 41
