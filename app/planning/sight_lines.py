"""Which targets can be seen from where, whatever the heading: front, incidence, distance, and walls between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.target_map import MappedTarget
from app.planning.plan_view import SightLimits
from app.planning.plan_walls import Wall
from app.planning.posting import UP
from app.targets.layout import BASE_CELLS

Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Index = npt.NDArray[np.intp]

TOUCHING_M = 0.005  # a wall nearer than this to a dot carries it: maps and plans agree to millimetres
CORNERS = BASE_CELLS  # four corners and one inside: what hides none of these hides hardly a dot
RAYS = 16  # level ones, to tell whether a place lies behind walls
PAIRS_AT_ONCE = 20_000  # bounds the memory: some 300 bytes each


@dataclass(frozen=True)
class SightLines:
    """Pairs of a position and a target that it may see, by ascending position.

    Attributes
    ----------
    position, target : ndarray of shape (N,)
        Which position sees which target.
    starts : ndarray of shape (P + 1,)
        The pairs of position p are ``starts[p]`` to ``starts[p + 1]``.
    """

    position: Index
    target: Index
    starts: Index

    def of(self, position: int) -> Index:
        """Targets that one position may see."""
        return self.target[self.starts[position] : self.starts[position + 1]]


def find_sight_lines(
    positions_m: Array, targets: Sequence[MappedTarget], walls: Sequence[Wall], sight: tuple[float, SightLimits]
) -> SightLines:
    """Targets that turn their front, are large enough and behind no wall, for positions of shape (P, 3).

    Parameters
    ----------
    positions_m : ndarray of shape (P, 3)
    targets : sequence of MappedTarget
    walls : sequence of Wall
        They hide from either side.
    sight : tuple
        The camera's focal length, px, and the limits. A target's size is taken at its distance, which is no less than
        its depth in any direction of view.
    """
    focal_px, limits = sight
    kept = [_facing(positions_m, target, (focal_px, limits)) for target in targets]
    seen = np.array(kept).reshape(len(targets), len(positions_m)).T
    position, target = np.nonzero(seen)
    ends_m = np.array([one.dots_m[list(CORNERS)] for one in targets]).reshape(-1, len(CORNERS), 3)
    screens = Screens.of(walls)
    free = np.ones(len(position), dtype=np.bool_)
    for start in range(0, len(position), PAIRS_AT_ONCE):
        part = slice(start, start + PAIRS_AT_ONCE)
        free[part] = ~screens.hide(positions_m[position[part], None], ends_m[target[part]]).any(axis=-1)
    position, target = position[free], target[free]
    return SightLines(position, target, np.searchsorted(position, np.arange(len(positions_m) + 1)))


def lie_open(positions_m: Array, walls: Sequence[Wall], clearance_m: float) -> Flags:
    """Which positions, shape (P, 3), are before walls rather than behind or in them, and not too near.

    A position is behind walls when most level rays that meet any meet a back first.
    """
    if not walls:
        return np.ones(len(positions_m), dtype=np.bool_)
    screens = Screens.of(walls)
    angle = np.arange(RAYS) * 2.0 * np.pi / RAYS + 1e-3  # aside of walls along the axes
    level = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(RAYS)])
    distance_m, front = screens.first(positions_m, level)
    met = np.isfinite(distance_m)
    backs = (met & ~front).sum(axis=1)
    return np.asarray((2 * backs <= met.sum(axis=1)) & (screens.clearance_m(positions_m) >= clearance_m))


def _facing(positions_m: Array, target: MappedTarget, sight: tuple[float, SightLimits]) -> Flags:
    """From which positions a target is seen from its front, not too slanted and not too far, shape (P,)."""
    focal_px, limits = sight
    towards_m = positions_m - target.site_from_target.position_m
    distance_m = np.maximum(np.linalg.norm(towards_m, axis=1), np.finfo(np.float64).tiny)
    cosine = towards_m @ target.site_from_target.rotation[:, 2] / distance_m
    u_m = module_m(target)
    # Towards the frame's edge depth falls below distance: sizes are checked once more by depth, in the view.
    near = focal_px * u_m >= limits.min_px_per_u * distance_m * np.cos(np.radians(limits.max_incidence_deg))
    return np.asarray((cosine >= np.cos(np.radians(limits.max_incidence_deg))) & near)


def module_m(target: MappedTarget) -> float:
    """A target's module by its dots: a third of the steps between them."""
    a, b, c, d = (target.dots_m[cell] for cell in BASE_CELLS[:4])
    return float((np.linalg.norm(c - a) + np.linalg.norm(d - b)) / (2.0 * np.hypot(9.0, 9.0)))


@dataclass(frozen=True)
class Screens:
    """W walls as arrays.

    Attributes
    ----------
    rotations : ndarray of shape (W, 3, 3)
        ``site_from_wall``.
    middles_m : ndarray of shape (W, 3)
    halves_m : ndarray of shape (W, 2)
        Half of the width and of the height.
    """

    rotations: Array
    middles_m: Array
    halves_m: Array

    @classmethod
    def of(cls, walls: Sequence[Wall]) -> Screens:
        """The arrays of walls."""
        return cls(
            np.array([wall.site_from_wall.rotation for wall in walls]).reshape(-1, 3, 3),
            np.array([wall.site_from_wall.position_m for wall in walls]).reshape(-1, 3),
            np.array([[wall.width_m, wall.height_m] for wall in walls]).reshape(-1, 2) / 2.0,
        )

    def hide(self, eyes_m: Array, ends_m: Array) -> Flags:
        """Which sight lines from eyes (..., 3) to ends (..., 3), broadcast together, a wall crosses."""
        hidden = np.zeros(np.broadcast_shapes(eyes_m.shape, ends_m.shape)[:-1], dtype=np.bool_)
        for rotation, middle_m, half_m in zip(self.rotations, self.middles_m, self.halves_m, strict=True):
            eye, end = (eyes_m - middle_m) @ rotation, (ends_m - middle_m) @ rotation
            parted = (eye[..., 2] * end[..., 2] < 0) & (np.abs(end[..., 2]) > TOUCHING_M)
            share = eye[..., 2] / np.where(parted, eye[..., 2] - end[..., 2], 1.0)
            crossing_m = eye[..., :2] + share[..., None] * (end[..., :2] - eye[..., :2])
            hidden |= parted & (np.abs(crossing_m) <= half_m).all(axis=-1)
        return hidden

    def first(self, eyes_m: Array, directions: Array) -> tuple[Array, Flags]:
        """Distance (P, R) to the first wall that rays (R, 3) from eyes (P, 3) meet, and whether they meet its front."""
        nearest_m = np.full((len(eyes_m), len(directions)), np.inf)
        front = np.zeros(nearest_m.shape, dtype=np.bool_)
        for rotation, middle_m, half_m in zip(self.rotations, self.middles_m, self.halves_m, strict=True):
            eye, ray = (eyes_m - middle_m) @ rotation, directions @ rotation
            crossing = np.abs(ray[:, 2]) > np.finfo(np.float32).eps
            reach_m = np.where(crossing, -eye[:, 2:] / np.where(crossing, ray[:, 2], 1.0), np.inf)
            at_m = eye[:, None, :2] + np.where(crossing, reach_m, 0.0)[..., None] * ray[:, :2]
            met = crossing & (reach_m >= 0) & (reach_m < nearest_m) & (np.abs(at_m) <= half_m).all(axis=-1)
            nearest_m = np.where(met, reach_m, nearest_m)
            front = np.where(met, eye[:, 2:] >= 0, front)
        return nearest_m, front

    def clearance_m(self, eyes_m: Array) -> Array:
        """Distance of eyes (P, 3) to the nearest upright wall, shape (P,); infinite where there is none."""
        least_m = np.full(len(eyes_m), np.inf)
        for rotation, middle_m, half_m in zip(self.rotations, self.middles_m, self.halves_m, strict=True):
            if abs(float(UP @ rotation[:, 2])) > np.sqrt(0.5):
                continue  # floor and ceiling
            eye = (eyes_m - middle_m) @ rotation
            beside_m = np.maximum(np.abs(eye[:, :2]) - half_m, 0.0)
            least_m = np.minimum(least_m, np.sqrt((beside_m**2).sum(axis=1) + eye[:, 2] ** 2))
        return least_m
