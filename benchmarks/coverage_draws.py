"""Photographs that were never taken: redraws of all that errs in a planned view, located by the resection."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated
from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera
from app.geometry.observations import TargetObservation
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.photogrammetry.resection import resect
from app.photogrammetry.resection_input import SightedTargets
from app.planning.dot_errors import DotErrorOptions
from app.targets.layout import DOT_COUNT
from benchmarks.pose_scene import moved

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class PlannedView:
    """A view as the planner sees it.

    Attributes
    ----------
    site_from_cam : Pose
    sighted : SightedTargets
        Images without any error.
    target_map : TargetMap
        The targets in view, where they are.
    camera : CalibratedCamera
    dot_errors : DotErrorOptions
    """

    site_from_cam: Pose
    sighted: SightedTargets
    target_map: TargetMap
    camera: CalibratedCamera
    dot_errors: DotErrorOptions


def position_errors(view: PlannedView, draws: int, rng: np.random.Generator) -> Iterator[Array | None]:
    """Errors of positions, shape (3,), m, of redrawn photographs; None for one that is not located."""
    camera = view.camera.camera
    root = _root(view.camera.covariance)
    for _ in range(draws):
        intrinsics = camera.intrinsics + root @ rng.normal(size=INTRINSIC_COUNT)
        calibrated = replace(view.camera, camera=camera.with_intrinsics(intrinsics))
        try:
            located = resect(draw_observations(view, rng), draw_map(view.target_map, rng), calibrated)
        except NotLocated:
            yield None
        else:
            yield located.site_from_cam.position_m - view.site_from_cam.position_m


def draw_observations(view: PlannedView, rng: np.random.Generator) -> list[TargetObservation]:
    """What a detector would say: each dot errs by itself, and all of a plate together."""
    sighted, sigmas = view.sighted, view.dot_errors.plate_sigmas
    observations = []
    for index in range(len(sighted)):
        independent = sigmas.dots * rng.normal(size=2 * DOT_COUNT)
        basis = sighted.modes[index].T
        errors = independent + basis @ (sigmas.of_modes * rng.normal(size=6) - basis.T @ independent)
        whitening = _lower(sighted.whiteners[index], sighted.measured[index])
        colouring = np.asarray(np.linalg.inv(whitening), dtype=np.float64)
        errors_px = np.einsum("dij,dj->di", colouring, errors.reshape(DOT_COUNT, 2))
        centres_px = sighted.observed_px[index] + np.where(sighted.measured[index][:, None], errors_px, 0.0)
        covariances_px2 = colouring @ np.swapaxes(colouring, -1, -2)
        code = int(sighted.codes[index])
        seen = TargetObservation(code, centres_px, covariances_px2, sighted.measured[index], plate_sigmas=sigmas)
        observations.append(seen)
    return observations


def draw_map(target_map: TargetMap, rng: np.random.Generator) -> TargetMap:
    """The map as a survey might have it: each target errs, and all err together by the datum."""
    shift = _root(target_map.datum.covariance) @ rng.normal(size=7)
    targets = tuple(
        _shifted(moved(target, _root(target.covariance) @ rng.normal(size=6)), target_map.datum, shift)
        for target in target_map.targets
    )
    return replace(target_map, targets=targets)


def _shifted(target: MappedTarget, datum: Datum, shift: Array) -> MappedTarget:
    pose = target.site_from_target
    centre_m = pose.position_m + datum.point_jacobian(pose.position_m) @ shift
    dots_m = target.dots_m + datum.point_jacobian(target.dots_m) @ shift
    return replace(target, site_from_target=Pose(exp_rotation(shift[3:6]) @ pose.rotation, centre_m), dots_m=dots_m)


def _root(covariance: Array) -> Array:
    """A square root of a covariance, which may be singular."""
    variances, axes = np.linalg.eigh(covariance)
    return np.asarray(axes * np.sqrt(np.maximum(variances, 0.0)))


def _lower(whitener: Array, measured: npt.NDArray[np.bool_]) -> Array:
    """Lower triangles, shape (16, 2, 2); the identity where nothing is measured."""
    lower = np.tile(np.eye(2), (DOT_COUNT, 1, 1))
    lower[measured, 0, 0], lower[measured, 1, 0], lower[measured, 1, 1] = whitener[measured].T
    return lower
