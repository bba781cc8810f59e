"""The target map: what a survey publishes and a resection looks up."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.targets.layout import DOT_COUNT

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class MappedTarget:
    """One target of a map.

    Attributes
    ----------
    code : int
    site_from_target : Pose
    dots_m : ndarray of shape (16, 3)
        Dot centres in the site frame, row-major cells, print scale included.
    covariance : ndarray of shape (6, 6)
        The target's own uncertainty, relative to the datum: position (m, site axes), small rotation (rad, site
        axes) about the target's centre.
    rays : int
        Photographs that see the target.
    rms_px : float
        Root mean square residual of its dots.
    """

    code: int
    site_from_target: Pose
    dots_m: Array
    covariance: Array
    rays: int
    rms_px: float

    def __post_init__(self) -> None:
        if self.dots_m.shape != (DOT_COUNT, 3) or self.covariance.shape != (6, 6):
            raise ValueError("a mapped target holds sixteen dots and a 6 x 6 covariance")


@dataclass(frozen=True)
class Datum:
    """The part of the map's uncertainty that all targets share: a small similarity about an origin.

    A point p moves by ``translation + rotation x (p - origin_m) + log_scale * (p - origin_m)``.

    Attributes
    ----------
    origin_m : ndarray of shape (3,)
    covariance : ndarray of shape (7, 7)
        translation (m), rotation (rad), log-scale.
    assumed_scale, assumed_orientation : bool
        True when no control fixed them (scale from the printed pitch; z from the plates).
    """

    origin_m: Array
    covariance: Array
    assumed_scale: bool = False
    assumed_orientation: bool = False

    def point_jacobian(self, points_m: Array) -> Array:
        """Derivative of points by the seven parameters, shape (..., 3, 7)."""
        offset = points_m - self.origin_m
        x, y, z = offset[..., 0], offset[..., 1], offset[..., 2]
        jacobian = np.zeros((*offset.shape[:-1], 3, 7))
        jacobian[..., 0, 0] = jacobian[..., 1, 1] = jacobian[..., 2, 2] = 1.0
        jacobian[..., 0, 4], jacobian[..., 0, 5] = z, -y
        jacobian[..., 1, 3], jacobian[..., 1, 5] = -z, x
        jacobian[..., 2, 3], jacobian[..., 2, 4] = y, -x
        jacobian[..., 6] = offset
        return jacobian

    def pose_covariance(self, position_m: Array) -> Array:
        """What the datum adds to the 6 x 6 covariance of a pose at a position: the shared part, propagated once."""
        jacobian = np.zeros((6, 7))
        jacobian[:3] = self.point_jacobian(position_m)
        jacobian[3:, 3:6] = np.eye(3)
        return jacobian @ self.covariance @ jacobian.T


@dataclass(frozen=True)
class TargetMap:
    """All targets of a site in one datum.

    Attributes
    ----------
    targets : tuple of MappedTarget
        Codes unique.
    datum : Datum
    code_family : str
    u_m : float
        Nominal module of the site's plates.
    """

    targets: tuple[MappedTarget, ...]
    datum: Datum
    code_family: str
    u_m: float
    by_code: dict[int, MappedTarget] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        by_code = {target.code: target for target in self.targets}
        if len(by_code) != len(self.targets):
            raise ValueError("one code stands once in a target map")
        object.__setattr__(self, "by_code", by_code)

    def bounds_m(self) -> tuple[Array, Array]:
        """Least and greatest coordinates of all dots, each of shape (3,)."""
        return self._bounds_m

    @cached_property
    def _bounds_m(self) -> tuple[Array, Array]:
        dots_m = np.concatenate([target.dots_m for target in self.targets])
        return dots_m.min(axis=0), dots_m.max(axis=0)
