"""The state of a growing network: which photographs and targets stand, and the mirror images not yet ruled out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.found_batches import BatchOptions
from app.photogrammetry.network import Network
from app.photogrammetry.robust import RobustLoss

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]
Value = TypeVar("Value", bound=np.generic)


@dataclass(frozen=True)
class GrowthOptions:
    """How a network is grown.

    Attributes
    ----------
    tolerance : float
        Residual, as a fraction of the focal length, at which a target stops speaking for a pose: 7 px at 1400 px,
        several times what a start from single targets misses by and far less than a mirrored target or a false code.
    focal_share : float
        Added to the tolerance before the first adjustment: this share of the focal length's relative sigma, since a
        wrong focal length shifts images by that share of their distance from the middle.
    voters : int
        Targets per photograph whose planar poses are tried as starts, the largest first.
    views : int
        Photographs per target whose planar poses are tried, the largest first.
    other_angle_rad : float
        Poses nearer than this are one solution; the two planar solutions lie twice the incidence apart.
    decided_ratio : float
        A mirror image is ruled out when it costs this many times the other; noise alone makes ratios near 1.
    least_agreeing : float
        Share of the known targets in a photograph that must agree with its pose.
    fewest_agreeing : int
        And how many at least: one target alone agrees with the pose that it gives, also when it is misread.
    growth_per_adjustment : float
        The network is adjusted each time it has grown by this factor.
    adjustment_steps : int
        Steps of those adjustments.
    adjusted_share : float
        They end when a step lowers the weighted squares by less than this share: what is still to come moves more.
    loss_width : float
        Width of the Cauchy loss of those adjustments, in robust standard deviations of the present residuals.
    strayed : float
        After an adjustment a target or photograph whose residuals exceed the others' by this factor, and the
        tolerance, is taken out and tried anew.
    batches : BatchOptions
    """

    tolerance: float = 0.005
    focal_share: float = 0.5
    voters: int = 10
    views: int = 3
    other_angle_rad: float = 0.1
    decided_ratio: float = 2.0
    least_agreeing: float = 0.5
    fewest_agreeing: int = 2
    growth_per_adjustment: float = 1.5
    adjustment_steps: int = 8
    adjusted_share: float = 0.01
    loss_width: float = 3.0
    strayed: float = 5.0
    batches: BatchOptions = field(default_factory=BatchOptions)


@dataclass(frozen=True)
class Growth:
    """A network under construction, in the frame ``model`` of its first photograph.

    Attributes
    ----------
    problem : BundleProblem
        All photographs and targets of the survey, also those that do not stand yet.
    network : Network
        Poses; meaningless where neither oriented nor placed.
    mirror_rotations, mirror_positions_m : ndarray of shape (T, 3, 3), (T, 3)
        The other planar solution of each placed target; equal to the network's where it is decided.
    oriented : ndarray of shape (P,), bool
    placed, decided : ndarray of shape (T,), bool
    adjusted_photos : int
        Photographs in the last adjustment, 0 before the first.
    """

    problem: BundleProblem
    network: Network
    mirror_rotations: Array
    mirror_positions_m: Array
    oriented: Mask
    placed: Mask
    decided: Mask
    adjusted_photos: int = 0
    options: GrowthOptions = field(default_factory=GrowthOptions)

    @property
    def tolerance(self) -> float:
        """Residual, as a fraction of the focal length, beyond which a sighting does not speak for a pose."""
        if self.adjusted_photos:
            return self.options.tolerance
        relative = [np.sqrt(known.covariance[0, 0]) / known.camera.fx_px for known in self.problem.cameras]
        return self.options.tolerance + self.options.focal_share * float(max(relative))

    @property
    def capture_loss(self) -> RobustLoss:
        """Loss of residuals in standard deviations that forgets what lies beyond the tolerance."""
        focal_px = float(np.median(self.network.intrinsics[:, 0]))
        return RobustLoss("cauchy", self.tolerance * focal_px * self.problem.sightings.typical_weight_per_px)

    def hypotheses(self, targets: Index) -> tuple[Array, Array]:
        """Both poses ``model_from_target`` of some targets, shapes (n, 2, 3, 3) and (n, 2, 3)."""
        rotations = np.stack([self.network.target_rotations[targets], self.mirror_rotations[targets]], axis=1)
        positions_m = np.stack([self.network.target_positions_m[targets], self.mirror_positions_m[targets]], axis=1)
        return rotations, positions_m

    def with_photos(self, photos: Index, rotations: Array, positions_m: Array) -> Growth:
        """The growth with some photographs oriented."""
        network = replace(
            self.network,
            photo_rotations=_put(self.network.photo_rotations, photos, rotations),
            photo_positions_m=_put(self.network.photo_positions_m, photos, positions_m),
        )
        return replace(self, network=network, oriented=_put(self.oriented, photos, np.True_))

    def with_targets(self, targets: Index, rotations: Array, positions_m: Array, decided: Mask) -> Growth:
        """The growth with some targets placed; both poses of each, shapes (n, 2, 3, 3) and (n, 2, 3), better first."""
        network = replace(
            self.network,
            target_rotations=_put(self.network.target_rotations, targets, rotations[:, 0]),
            target_positions_m=_put(self.network.target_positions_m, targets, positions_m[:, 0]),
        )
        other = np.where(decided, 0, 1)
        row = np.arange(len(targets))
        return replace(
            self,
            network=network,
            mirror_rotations=_put(self.mirror_rotations, targets, rotations[row, other]),
            mirror_positions_m=_put(self.mirror_positions_m, targets, positions_m[row, other]),
            placed=_put(self.placed, targets, np.True_),
            decided=_put(self.decided, targets, decided),
        )


def seeded(problem: BundleProblem, photo: int, options: GrowthOptions) -> Growth:
    """A growth of one photograph, which is the frame ``model``."""
    photos, targets = problem.sightings.photo_count, problem.sightings.target_count
    network = Network(
        np.tile(np.eye(3), (photos, 1, 1)),
        np.zeros((photos, 3)),
        np.tile(np.eye(3), (targets, 1, 1)),
        np.zeros((targets, 3)),
        np.array([known.camera.intrinsics for known in problem.cameras]),
        problem.prints.of_targets,
    )
    nothing = np.zeros(targets, dtype=np.bool_)
    oriented = np.arange(photos) == photo
    mirrors = network.target_rotations, network.target_positions_m
    return Growth(problem, network, *mirrors, oriented, nothing, nothing, options=options)


def _put(values: npt.NDArray[Value], index: Index, new: npt.ArrayLike) -> npt.NDArray[Value]:
    changed = values.copy()
    changed[index] = new
    return changed
