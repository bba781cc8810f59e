"""What one photograph sees of the target map, as arrays over its targets: the input of every step of a resection."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.geometry.observations import TargetObservation
from app.geometry.plate_sigmas import MODE_COUNT, PlateSigmas
from app.geometry.target_map import TargetMap
from app.photogrammetry.kernels.layout import OWN
from app.photogrammetry.kernels.shared_errors import find_modes, whiten_dots
from app.targets.layout import DOT_COUNT, dot_centres_u

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Index = npt.NDArray[np.intp] | Mask

PLATE_SHAPES = np.concatenate([np.ones((DOT_COUNT, 1)), dot_centres_u()], axis=1)  # 1, x, y over the plate


@dataclass(frozen=True)
class SightedTargets:
    """K mapped targets of one photograph.

    Attributes
    ----------
    codes : ndarray of shape (K,), int
    rotations : ndarray of shape (K, 3, 3)
        ``site_from_target``.
    centres_m : ndarray of shape (K, 3)
        The targets' centres in the site frame.
    arms_m : ndarray of shape (K, 16, 3)
        From the centre to each dot, site axes.
    own_covariances : ndarray of shape (K, 6, 6)
        Each target's own uncertainty: position (m), small rotation (rad) about its centre, site axes.
    observed_px : ndarray of shape (K, 16, 2)
        Measured dot centres.
    whiteners : ndarray of shape (K, 16, 3)
        Elements (0, 0), (1, 0), (1, 1) of the lower triangular W with W^T W = covariance^-1, 1 / px; zero where a dot
        was not measured, so that it weighs nothing.
    measured : ndarray of shape (K, 16), bool
    modes : ndarray of shape (K, 6, 32)
        Orthonormal errors of the whitened coordinates that the dots of a sighting share.
    plate_sigmas : ndarray of shape (K, 3)
        How large shifts, linear deformations and the errors of single dots are, over what the whiteners say.
    """

    codes: npt.NDArray[np.int64]
    rotations: Array
    centres_m: Array
    arms_m: Array
    own_covariances: Array
    observed_px: Array
    whiteners: Array
    measured: Mask
    modes: Array
    plate_sigmas: Array

    def __len__(self) -> int:
        return len(self.codes)

    @property
    def arrays(self) -> tuple[Array, Array, Array, Array, Array, Array, Mask, Array, Array]:
        """All but the codes, in their order, as compiled loops take them."""
        seen = (self.own_covariances, self.observed_px, self.whiteners, self.measured, self.modes, self.plate_sigmas)
        return (self.rotations, self.centres_m, self.arms_m, *seen)

    @property
    def dots_m(self) -> Array:
        """Dots in the site frame, shape (K, 16, 3)."""
        return self.centres_m[:, None] + self.arms_m

    @cached_property
    def dot_counts(self) -> npt.NDArray[np.intp]:
        """Measured dots of each target, shape (K,)."""
        return np.count_nonzero(self.measured, axis=1)

    @cached_property
    def freedoms(self) -> npt.NDArray[np.intp]:
        """Degrees of freedom of each target's rigid movement, shape (K,): six, or less where dots are few."""
        return np.minimum(OWN, 2 * self.dot_counts)

    def where(self, mask: Mask) -> SightedTargets:
        """Those of a mask of shape (K,), which are mostly all."""
        return self if mask.all() else self.take(mask)

    def take(self, index: Index) -> SightedTargets:
        """Some of the targets."""
        return SightedTargets(
            self.codes[index],
            self.rotations[index],
            self.centres_m[index],
            self.arms_m[index],
            self.own_covariances[index],
            self.observed_px[index],
            self.whiteners[index],
            self.measured[index],
            self.modes[index],
            self.plate_sigmas[index],
        )


def sight_targets(observations: Sequence[TargetObservation], target_map: TargetMap) -> SightedTargets:
    """Pair observations with the map; every code must stand in it.

    Raises
    ------
    ValueError
        When a measured dot's covariance is not positive definite.
    """
    mapped = [target_map.by_code[observation.code] for observation in observations]
    measured = np.array([seen.measured for seen in observations])
    whiteners, modes = _weights(np.array([seen.covariances_px2 for seen in observations]), measured)
    centres_m = np.array([target.site_from_target.position_m for target in mapped])
    return SightedTargets(
        codes=np.array([target.code for target in mapped], dtype=np.int64),
        rotations=np.array([target.site_from_target.rotation for target in mapped]),
        centres_m=centres_m,
        arms_m=np.array([target.dots_m for target in mapped]) - centres_m[:, None],
        own_covariances=np.array([target.covariance for target in mapped]),
        observed_px=np.array([seen.centres_px for seen in observations]),
        whiteners=whiteners,
        measured=measured,
        modes=modes,
        plate_sigmas=np.array([_three(seen.plate_sigmas) for seen in observations], dtype=np.float64),
    )


def _three(sigmas: PlateSigmas) -> tuple[float, float, float]:
    """``astuple`` at a tenth of its price: it copies deeply."""
    return sigmas.shift, sigmas.linear, sigmas.dots


def _weights(covariances_px2: Array, measured: Mask) -> tuple[Array, Array]:
    """Whiteners and modes of sightings.

    Raises
    ------
    ValueError
        When a measured dot's covariance is not positive definite.
    """
    whiteners, modes = np.empty((*measured.shape, 3)), np.empty((len(measured), MODE_COUNT, 2 * DOT_COUNT))
    if not whiten_dots(covariances_px2, measured, whiteners):
        raise ValueError("the covariance of each measured dot must be finite and positive definite")
    find_modes(whiteners, PLATE_SHAPES, modes)
    return whiteners, modes
