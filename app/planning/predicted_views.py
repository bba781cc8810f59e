"""What cameras at one position will see of a map in each direction: the observations of a resection, not yet made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import CalibratedCamera, Camera
from app.geometry.plate_sigmas import MODE_COUNT
from app.geometry.pose import Pose
from app.geometry.target_map import MappedTarget
from app.photogrammetry.kernels.shared_errors import find_modes
from app.photogrammetry.resection_input import PLATE_SHAPES, SightedTargets
from app.planning.depth_order import NEAREST_M
from app.planning.dot_errors import DotErrorOptions, Light, dot_information
from app.planning.plan_view import SightLimits
from app.planning.sight_lines import module_m
from app.targets.digits import BLACK, digits_of_codes
from app.targets.layout import DIGIT_CELLS, DOT_COUNT, dot_centres_u

Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Index = npt.NDArray[np.intp]

BORDER_U = 1.0  # of the picture around a dot's centre: the dot itself
HALF_PIXEL = 0.5  # pixel centres are integers: the frame ends half a pixel beyond the outermost


@dataclass(frozen=True)
class Seeing:
    """How cameras see: the intrinsics with their uncertainty, what targets need to count, and the light."""

    camera: CalibratedCamera
    limits: SightLimits = SightLimits()
    light: Light = "indoor"
    dot_errors: DotErrorOptions = DotErrorOptions()


@dataclass(frozen=True)
class MapArrays:
    """T targets of a map as arrays.

    Attributes
    ----------
    codes : ndarray of shape (T,), int
    rotations : ndarray of shape (T, 3, 3)
    centres_m : ndarray of shape (T, 3)
    dots_m : ndarray of shape (T, 16, 3)
    own_covariances : ndarray of shape (T, 6, 6)
    modules_m : ndarray of shape (T,)
    lit : ndarray of shape (T, 16), bool
        Dots that can be measured: all but the black ones.
    """

    codes: npt.NDArray[np.int64]
    rotations: Array
    centres_m: Array
    dots_m: Array
    own_covariances: Array
    modules_m: Array
    lit: Flags

    @classmethod
    def of(cls, targets: Sequence[MappedTarget]) -> MapArrays:
        """The arrays of a map's targets."""
        codes = np.array([target.code for target in targets], dtype=np.int64)
        lit = np.ones((len(codes), DOT_COUNT), dtype=np.bool_)
        lit[:, list(DIGIT_CELLS)] = digits_of_codes(codes) != BLACK
        return cls(
            codes,
            np.array([target.site_from_target.rotation for target in targets]),
            np.array([target.site_from_target.position_m for target in targets]),
            np.array([target.dots_m for target in targets]),
            np.array([target.covariance for target in targets]),
            np.array([module_m(target) for target in targets]),
            lit,
        )


@dataclass(frozen=True)
class PredictedViews:
    """Sightings of V views from one position, by ascending view.

    Attributes
    ----------
    poses : tuple of Pose
        ``site_from_cam`` of each view.
    starts : ndarray of shape (V + 1,)
        The sightings of view v are ``starts[v]`` to ``starts[v + 1]``.
    target : ndarray of shape (N,)
        Which target of the map each sighting shows.
    sighted : SightedTargets
        All sightings; ``observed_px`` holds the images without any error.
    """

    poses: tuple[Pose, ...]
    starts: Index
    target: Index
    sighted: SightedTargets

    def of(self, view: int) -> SightedTargets:
        """The sightings of one view."""
        return self.sighted.take(np.arange(self.starts[view], self.starts[view + 1]))


def predict_views(arrays: MapArrays, candidates: Index, poses: tuple[Pose, ...], seeing: Seeing) -> PredictedViews:
    """What each pose sees of the targets ``candidates``, shape (K,), that nothing hides.

    A target is seen when all its dots lie wholly in the picture and it is as large as asked.
    """
    camera = seeing.camera.camera
    rotations = np.array([pose.rotation for pose in poses])
    positions_m = np.array([pose.position_m for pose in poses])
    dots_cam_m = (arrays.dots_m[candidates] - positions_m[:, None, None]) @ rotations[:, None]
    depths_m = dots_cam_m[..., 2]
    px_per_u = camera.fx_px * arrays.modules_m[candidates] / np.maximum(depths_m.mean(axis=-1), NEAREST_M)
    seen = (depths_m.min(axis=-1) > NEAREST_M) & (px_per_u >= seeing.limits.min_px_per_u)
    seen[seen] &= _inside(dots_cam_m[seen], px_per_u[seen], camera)
    view, chosen = np.nonzero(seen)
    target = candidates[chosen]
    images_px = camera.project(dots_cam_m[seen])
    sighted = _sightings(arrays, target, images_px, seeing)
    return PredictedViews(poses, np.searchsorted(view, np.arange(len(poses) + 1)), target, sighted)


def _inside(dots_cam_m: Array, px_per_u: Array, camera: Camera) -> Flags:
    """Which plates, shape (N, 16, 3), lie wholly in the picture."""
    # Far outside the frame a lens polynomial may fold back into it: the straight ray decides first.
    fx, fy, cx, cy = camera.intrinsics[:4]
    size_px = np.array([camera.width_px, camera.height_px])
    straight_px = dots_cam_m[..., :2] / dots_cam_m[..., 2:] * [fx, fy] + [cx, cy]
    near = (np.abs(straight_px - size_px / 2) <= size_px).all(axis=(1, 2))
    images_px = camera.project(dots_cam_m)
    border_px = (BORDER_U * px_per_u - HALF_PIXEL)[:, None, None]
    return np.asarray(near & ((images_px >= border_px) & (images_px <= size_px - 1 - border_px)).all(axis=(1, 2)))


def _sightings(arrays: MapArrays, target: Index, images_px: Array, seeing: Seeing) -> SightedTargets:
    measured = arrays.lit[target]
    # One derivative per plate: over a plate it varies by the few percent that perspective makes.
    plane = dot_centres_u() / (dot_centres_u() ** 2).sum(axis=0)
    px_by_u = np.swapaxes(images_px, -1, -2) @ plane
    whiteners = np.repeat(_whitener(dot_information(px_by_u, seeing.light, seeing.dot_errors))[:, None], DOT_COUNT, 1)
    whiteners = np.ascontiguousarray(whiteners * measured[..., None])
    modes = np.empty((len(target), MODE_COUNT, 2 * DOT_COUNT))
    find_modes(whiteners, PLATE_SHAPES, modes)
    shared = seeing.dot_errors.plate_sigmas
    return SightedTargets(
        codes=arrays.codes[target],
        rotations=arrays.rotations[target],
        centres_m=arrays.centres_m[target],
        arms_m=arrays.dots_m[target] - arrays.centres_m[target][:, None],
        own_covariances=arrays.own_covariances[target],
        observed_px=np.ascontiguousarray(images_px),
        whiteners=whiteners,
        measured=measured,
        modes=modes,
        plate_sigmas=np.tile([shared.shift, shared.linear, shared.dots], (len(target), 1)),
    )


def _whitener(information: Array) -> Array:
    """Elements (0, 0), (1, 0), (1, 1) of the lower triangular W with W^T W = information, shape (..., 3)."""
    xx, xy, yy = information[..., 0, 0], information[..., 0, 1], information[..., 1, 1]
    last = np.sqrt(yy)
    return np.stack([np.sqrt(np.maximum(xx - xy * xy / yy, 0.0)), xy / last, last], axis=-1)
