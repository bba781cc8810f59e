"""Synthetic truth for resections: plates on walls, a distorted camera, dots with covariances; all of it redrawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.camera import CalibratedCamera, Camera
from app.geometry.observations import TargetObservation
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation, log_rotation
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.targets.layout import DEFAULT_U_M, DOT_COUNT, dots_target_m

Array = npt.NDArray[np.float64]

CAMERA = Camera(1920, 1080, np.array([1391.7, 1390.2, 951.3, 547.9, 0.091, -0.187, 6e-4, -9e-4, 0.052]))
CAMERA_SIGMAS = np.array([0.8, 0.8, 0.6, 0.6, 0.002, 0.008, 1e-4, 1e-4, 0.008])
DOT_SIGMA_PX = 0.08
OWN_SIGMAS = np.array([2e-4, 2e-4, 2e-4, 6e-4, 6e-4, 6e-4])  # of a target: m, rad
DATUM_SIGMAS = np.array([5e-4, 5e-4, 5e-4, 1e-4, 1e-4, 1e-4, 1e-4])  # m, rad, log-scale
NO_DATUM = Datum(np.zeros(3), np.zeros((7, 7)))
TOWARDS_Y = (0.0, -1.0, 0.0)  # normal of plates on a wall that is seen looking along +Y


@dataclass(frozen=True)
class Scene:
    """A photograph's truth, with the uncertainties that redraws follow."""

    site_from_cam: Pose
    target_map: TargetMap
    camera: CalibratedCamera

    def without(self, *codes: int) -> Scene:
        """The scene without some targets."""
        return self.with_targets([target for target in self.target_map.targets if target.code not in codes])

    def with_targets(self, targets: Sequence[MappedTarget]) -> Scene:
        """The scene with other targets."""
        return replace(self, target_map=replace(self.target_map, targets=tuple(targets)))


def calibrated(scale: float = 1.0) -> CalibratedCamera:
    """The camera, with correlated intrinsics as a survey leaves them."""
    correlations = np.eye(9)
    for i, j, value in ((0, 1, 0.98), (4, 5, -0.9), (5, 8, -0.95), (4, 8, 0.8)):
        correlations[i, j] = correlations[j, i] = value
    sigmas = scale * CAMERA_SIGMAS
    return CalibratedCamera(CAMERA, correlations * np.outer(sigmas, sigmas), "survey")


def looking(position_m: Sequence[float], at_m: Sequence[float], roll_rad: float = 0.0) -> Pose:
    """``site_from_cam`` of an upright camera that looks at a point, then rolled about its axis."""
    forward = np.subtract(at_m, position_m) / np.linalg.norm(np.subtract(at_m, position_m))
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    upright = np.column_stack([right, np.cross(forward, right), forward])
    return Pose(upright @ exp_rotation(np.array([0.0, 0.0, roll_rad])), np.array(position_m, dtype=np.float64))


def plate(
    code: int, centre_m: Sequence[float], normal: Sequence[float] = TOWARDS_Y, roll_rad: float = 0.0
) -> MappedTarget:
    """A target at a place, facing along a normal."""
    z = np.array(normal) / np.linalg.norm(normal)
    x = np.cross([0.0, 0.0, 1.0], z)
    x /= np.linalg.norm(x)
    rotation = np.column_stack([x, np.cross(z, x), z]) @ exp_rotation(np.array([0.0, 0.0, roll_rad]))
    site_from_target = Pose(rotation, np.array(centre_m, dtype=np.float64))
    dots_m = site_from_target.apply(dots_target_m(DEFAULT_U_M))
    return MappedTarget(code, site_from_target, dots_m, np.diag(OWN_SIGMAS**2), rays=9, rms_px=0.1)


def map_of(targets: Sequence[MappedTarget], datum: Datum = NO_DATUM) -> TargetMap:
    """A target map."""
    return TargetMap(tuple(targets), datum, "golay", DEFAULT_U_M)


def room_scene(count: int, seed: int = 0, datum: Datum = NO_DATUM) -> Scene:
    """A camera 3 to 7 m before plates that stand on a wall and, tilted, nearer."""
    rng = np.random.default_rng(seed)
    site_from_cam = looking([4.0, 1.0, 1.5], [4.3, 7.0, 1.4], rng.uniform(-0.3, 0.3))
    targets: list[MappedTarget] = []
    while len(targets) < count:
        centre_m = [rng.uniform(1.0, 7.0), rng.choice([5.0, 6.0, 7.0]), rng.uniform(0.2, 2.8)]
        target = plate(len(targets) + 1, centre_m, [rng.uniform(-0.7, 0.7), -1.0, 0.1], rng.normal(0.0, 0.3))
        if is_in_view(target, site_from_cam):
            targets.append(target)
    return Scene(site_from_cam, map_of(targets, datum), calibrated())


def is_in_view(target: MappedTarget, site_from_cam: Pose, camera: Camera = CAMERA) -> bool:
    """Whether all dots stand in the picture."""
    cam_m = site_from_cam.inverse().apply(target.dots_m)
    if cam_m[:, 2].min() < 0.2:
        return False
    image_px = camera.project(cam_m)
    return bool((image_px > 0).all() and (image_px < [camera.width_px - 1, camera.height_px - 1]).all())


def observe(
    scene: Scene, rng: np.random.Generator | None = None, sigma_px: float = DOT_SIGMA_PX
) -> list[TargetObservation]:
    """What the true camera sees of the true map; exact without a generator, with noise of its covariance with one."""
    observations = []
    for target in scene.target_map.targets:
        centres_px = scene.camera.camera.project(scene.site_from_cam.inverse().apply(target.dots_m))
        # Ellipses of error lie differently from plate to plate, as foreshortened dots do.
        turn = exp_rotation(np.array([0.0, 0.0, float(target.code)]))[:2, :2]
        root_px = turn * [sigma_px, 1.4 * sigma_px]
        if rng is not None:
            centres_px = centres_px + rng.normal(size=(DOT_COUNT, 2)) @ root_px.T
        covariances_px2 = np.tile(root_px @ root_px.T, (DOT_COUNT, 1, 1))
        measured = np.ones(DOT_COUNT, dtype=np.bool_)
        observations.append(TargetObservation(target.code, centres_px, covariances_px2, measured))
    return observations


def redrawn_map(target_map: TargetMap, rng: np.random.Generator) -> TargetMap:
    """A map that errs as its covariances say: each target by itself, and all together by the datum."""
    datum = target_map.datum
    shift = _draw(datum.covariance, rng)
    targets = []
    for target in target_map.targets:
        own = _draw(target.covariance, rng)
        moved = displaced(target, own[:3], own[3:])
        centre_m, turn = moved.site_from_target.position_m, exp_rotation(shift[3:6])
        pose = Pose(turn @ moved.site_from_target.rotation, centre_m + datum.point_jacobian(centre_m) @ shift)
        dots_m = moved.dots_m + datum.point_jacobian(moved.dots_m) @ shift
        targets.append(replace(moved, site_from_target=pose, dots_m=dots_m))
    return replace(target_map, targets=tuple(targets))


def redrawn_camera(calibrated_camera: CalibratedCamera, rng: np.random.Generator) -> CalibratedCamera:
    """A calibration that errs as its covariance says."""
    camera = calibrated_camera.camera
    error = _draw(calibrated_camera.covariance, rng)
    return replace(calibrated_camera, camera=camera.with_intrinsics(camera.intrinsics + error))


def displaced(target: MappedTarget, shift_m: Array, turn_rad: Array) -> MappedTarget:
    """A target that stands elsewhere than where it stood."""
    pose, turn = target.site_from_target, exp_rotation(np.asarray(turn_rad, dtype=np.float64))
    centre_m = pose.position_m + shift_m
    dots_m = (target.dots_m - pose.position_m) @ turn.T + centre_m
    return replace(target, site_from_target=Pose(turn @ pose.rotation, centre_m), dots_m=dots_m)


def pose_error(estimate: Pose, truth: Pose) -> Array:
    """Estimate less truth, shape (6,): position (m), small rotation (rad), site axes."""
    turn_rad = log_rotation(estimate.rotation @ truth.rotation.T)
    return np.concatenate([estimate.position_m - truth.position_m, turn_rad])


def _draw(covariance: Array, rng: np.random.Generator) -> Array:
    """One draw of a zero-mean normal vector."""
    variances, axes = np.linalg.eigh(covariance)
    return np.asarray(axes @ (np.sqrt(np.maximum(variances, 0.0)) * rng.normal(size=len(variances))))
