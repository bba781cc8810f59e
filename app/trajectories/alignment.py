"""Take the estimate into the reference's frame: a rigid motion, heading and shift, a similarity, or a common start."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from app.errors import DegenerateGeometry, InvalidInput
from app.geometry.similarity import Similarity, estimate_similarity
from app.trajectories.association import Pairs
from app.trajectories.trajectory import Array, Trajectory

AlignmentKind = Literal["none", "se3", "posyaw", "sim3", "origin", "first_n"]
RotationSource = Literal["positions", "orientations"]

LEAST_PAIRS = 3  # points that fix a rotation in space; two fix a heading
LEAST_PAIRS_POSYAW = 2
FLAT = 1e-9  # extent over the largest below which points lie on one line: far under any noise, over any rounding


@dataclass(frozen=True)
class AlignmentOptions:
    """How the estimate is taken into the reference's frame.

    Attributes
    ----------
    alignment : {"none", "se3", "posyaw", "sim3", "origin", "first_n"}
        ``se3``: rotation and translation that fit best. ``posyaw``: heading about the vertical and translation, for
        systems that know which way is down. ``sim3``: scale too, for monocular ones. ``origin``: the first poses made
        equal. ``first_n``: ``se3`` from the first pairs alone.
    first_n : int
        Pairs of ``first_n``.
    rotation_from : {"positions", "orientations"}
        What fixes the rotation. Positions on a line, or few of them, fix none; orientations always do.
    """

    alignment: AlignmentKind = "none"
    first_n: int = 10
    rotation_from: RotationSource = "positions"

    def __post_init__(self) -> None:
        if self.first_n < LEAST_PAIRS:
            raise ValueError(f"first_n takes {LEAST_PAIRS} pairs at least, got {self.first_n}")


@dataclass(frozen=True)
class Alignment:
    """The relation that was found.

    Attributes
    ----------
    kind : str
        Which was asked for.
    site_from_estimate : Similarity
    pairs_used : int
        Pairs that fixed it; 0 for none.
    """

    kind: AlignmentKind
    site_from_estimate: Similarity
    pairs_used: int

    def apply(self, estimate: Trajectory) -> Trajectory:
        """The estimate in the reference's frame, covariances with it."""
        turn, scale = self.site_from_estimate.rotation, self.site_from_estimate.scale
        orientations = estimate.orientations_xyzw
        if orientations is not None and len(orientations):
            orientations = (Rotation.from_matrix(turn) * Rotation.from_quat(orientations)).as_quat(canonical=True)
        return replace(
            estimate,
            positions_m=self.site_from_estimate.apply(estimate.positions_m),
            orientations_xyzw=orientations,
            covariances=_turned(estimate.covariances, turn, scale),
        )


def _turned(covariances: Array | None, turn: Array, scale: float) -> Array | None:
    """Position and small rotation both stand in site axes, so both turn; lengths alone are scaled."""
    if covariances is None:
        return None
    jacobian = np.kron(np.eye(covariances.shape[-1] // 3), turn)
    jacobian[:3] *= scale
    return jacobian @ covariances @ jacobian.T


def align(pairs: Pairs, options: AlignmentOptions | None = None) -> Alignment:
    """Find the relation between the estimate's frame and the reference's.

    Parameters
    ----------
    pairs : Pairs
    options : AlignmentOptions, optional

    Raises
    ------
    DegenerateGeometry
        When the pairs do not fix it: too few, or positions on one line.
    InvalidInput
        When orientations are needed and one of the two has none.
    """
    options = options or AlignmentOptions()
    if options.alignment == "none":
        return Alignment("none", Similarity(1.0, np.eye(3), np.zeros(3)), 0)
    used = min(len(pairs), {"first_n": options.first_n, "origin": 1}.get(options.alignment, len(pairs)))
    similarity = _fit(pairs.first(used), options)
    return Alignment(options.alignment, similarity, used)


def _fit(pairs: Pairs, options: AlignmentOptions) -> Similarity:
    estimate_m, reference_m = pairs.estimate.positions_m, pairs.reference.positions_m
    if options.alignment == "origin" or options.rotation_from == "orientations":
        rotation = _rotation_of_orientations(pairs, heading_only=options.alignment == "posyaw")
        scale = _scale(estimate_m, reference_m, rotation) if options.alignment == "sim3" else 1.0
        return _through_the_means(estimate_m, reference_m, (scale, rotation))
    if options.alignment == "posyaw":
        return _through_the_means(estimate_m, reference_m, (1.0, _heading(estimate_m, reference_m)))
    _check_spread(estimate_m, reference_m)
    return estimate_similarity(estimate_m, reference_m, scale_is_free=options.alignment == "sim3")


def _through_the_means(estimate_m: Array, reference_m: Array, turn: tuple[float, Array]) -> Similarity:
    scale, rotation = turn
    shift_m = reference_m.mean(axis=0) - scale * rotation @ estimate_m.mean(axis=0)
    return Similarity(scale, rotation, shift_m)


def _check_spread(estimate_m: Array, reference_m: Array) -> None:
    """Two directions of extent in the product of both point sets fix a rotation."""
    if len(estimate_m) < LEAST_PAIRS:
        raise DegenerateGeometry(
            f"{len(estimate_m)} pairs fix no rotation; {LEAST_PAIRS} are needed: align by origin, or by orientations"
        )
    product = (estimate_m - estimate_m.mean(axis=0)).T @ (reference_m - reference_m.mean(axis=0))
    extent = np.linalg.svd(product, compute_uv=False)
    if extent[1] <= FLAT * extent[0]:
        raise DegenerateGeometry(
            "the positions lie on one line or in one point, which fixes no rotation: align with posyaw, "
            "by orientations, or by origin"
        )


def _heading(estimate_m: Array, reference_m: Array) -> Array:
    """The rotation about the vertical that fits best, in closed form: the angle of the summed plane products."""
    if len(estimate_m) < LEAST_PAIRS_POSYAW:
        raise DegenerateGeometry(f"one pair fixes no heading; {LEAST_PAIRS_POSYAW} are needed")
    source, goal = estimate_m - estimate_m.mean(axis=0), reference_m - reference_m.mean(axis=0)
    along = float((source[:, :2] * goal[:, :2]).sum())
    across = float((source[:, 0] * goal[:, 1] - source[:, 1] * goal[:, 0]).sum())
    size = float(np.sqrt((source[:, :2] ** 2).sum() * (goal[:, :2] ** 2).sum()))
    if np.hypot(along, across) <= FLAT * size or size == 0.0:
        raise DegenerateGeometry("the positions stand over one point, which fixes no heading: align by origin")
    return Rotation.from_rotvec([0.0, 0.0, np.arctan2(across, along)]).as_matrix()


def _rotation_of_orientations(pairs: Pairs, heading_only: bool) -> Array:
    """The chordal mean of ``R_reference R_estimate^T`` (Hartley et al., IJCV 103, 2013, section 5.3)."""
    reference, estimate = pairs.reference.rotations, pairs.estimate.rotations
    if reference is None or estimate is None:
        which = "reference" if reference is None else "estimate"
        raise InvalidInput(f"the {which} has positions only and this alignment takes orientations: align by positions")
    total = (reference @ estimate.transpose(0, 2, 1)).sum(axis=0)
    if heading_only:
        angle_rad = np.arctan2(total[1, 0] - total[0, 1], total[0, 0] + total[1, 1])
        return Rotation.from_rotvec([0.0, 0.0, angle_rad]).as_matrix()
    u, _, vt = np.linalg.svd(total)
    return u * np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))]) @ vt


def _scale(estimate_m: Array, reference_m: Array, rotation: Array) -> float:
    """The scale that fits best once the rotation is known."""
    source = (estimate_m - estimate_m.mean(axis=0)) @ rotation.T
    goal = reference_m - reference_m.mean(axis=0)
    squares = float((source**2).sum())
    scale = float((source * goal).sum()) / squares if squares > 0 else 0.0
    if scale <= 0:
        raise DegenerateGeometry("the positions fix no scale: align with se3 or by origin")
    return scale
