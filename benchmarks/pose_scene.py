"""Synthetic views of plates on walls, and redraws of all that errs: dots (with what a plate shares), map and camera."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.camera import CalibratedCamera, Camera
from app.geometry.observations import TargetObservation
from app.geometry.plate_sigmas import PlateSigmas
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation, log_rotation
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.photogrammetry.plate_correlation import plate_basis
from app.planning.posting import UP, pose_facing
from app.targets.layout import DEFAULT_U_M, DOT_COUNT, dots_target_m

Array = npt.NDArray[np.float64]

NO_DATUM = Datum(np.zeros(3), np.zeros((7, 7)))
LEAST_DEPTH_M = 0.2  # nearer than this no plate is wholly in view


@dataclass(frozen=True)
class ViewOptions:
    """A view and what errs in it.

    Attributes
    ----------
    targets : int
        Plates wholly in view.
    distance_m : float
        To the middle of the plates, which stand within a third of it in depth.
    incidence_rad : float
        Plates are turned by up to so much.
    dot_sigma_px : float
        Of a dot of 6 px diameter, as the detector has it in room-a.
    plate_sigmas : PlateSigmas
        What dots share, as the detector says.
    own_sigma_m, own_sigma_rad : float
        Of a target in the map of a survey of 54 photographs.
    focal_px, focal_share : float
        Focal length, and its standard deviation as a share: 6e-4 from a survey, 0.02 from EXIF alone.
    """

    targets: int = 5
    distance_m: float = 4.0
    incidence_rad: float = 0.7
    dot_sigma_px: float = 0.08
    plate_sigmas: PlateSigmas = PlateSigmas(1.3, 1.2, 0.85)
    own_sigma_m: float = 2e-4
    own_sigma_rad: float = 6e-4
    focal_px: float = 1400.0
    focal_share: float = 6e-4


@dataclass(frozen=True)
class View:
    """The truth of a photograph."""

    site_from_cam: Pose
    target_map: TargetMap
    camera: CalibratedCamera
    options: ViewOptions


def make_view(options: ViewOptions, seed: int) -> View:
    """A camera at a random attitude before plates that stand at random in its view."""
    rng = np.random.default_rng(seed)
    camera = Camera(1920, 1080, np.array([options.focal_px] * 2 + [955.0, 545.0, 0.05, -0.08, 3e-4, -2e-4, 0.02]))
    pixels = options.focal_share * options.focal_px, 0.6
    sigmas = np.array([pixels[0]] * 2 + [pixels[1]] * 2 + [2e-3, 4e-3, 1e-4, 1e-4, 3e-3])
    covariance = np.diag(sigmas**2)
    covariance[0, 1] = covariance[1, 0] = 0.98 * sigmas[0] ** 2
    site_from_cam = Pose(exp_rotation(rng.normal(0.0, 1.0, 3)), rng.uniform(-2.0, 2.0, 3))
    targets: list[MappedTarget] = []
    while len(targets) < options.targets:
        target = _random_target(len(targets) + 1, site_from_cam, options, rng)
        if _in_view(target, site_from_cam, camera):
            targets.append(target)
    target_map = TargetMap(tuple(targets), NO_DATUM, "golay", DEFAULT_U_M)
    return View(site_from_cam, target_map, CalibratedCamera(camera, covariance, "survey"), options)


def draw(view: View, rng: np.random.Generator) -> tuple[list[TargetObservation], TargetMap, CalibratedCamera]:
    """What a photograph, a survey and a calibration say, each with errors of its own covariance."""
    camera = view.camera.camera
    error = np.linalg.cholesky(view.camera.covariance) @ rng.normal(size=9)
    calibrated = replace(view.camera, camera=camera.with_intrinsics(camera.intrinsics + error))
    targets = [moved(target, _draw_own(target, rng)) for target in view.target_map.targets]
    return observe(view, rng), replace(view.target_map, targets=tuple(targets)), calibrated


def observe(view: View, rng: np.random.Generator) -> list[TargetObservation]:
    """The dots of all targets, with independent and shared errors."""
    sigmas, cam_from_site = view.options.plate_sigmas, view.site_from_cam.inverse()
    whitening = np.tile(np.eye(2) / view.options.dot_sigma_px, (1, DOT_COUNT, 1, 1))
    basis = plate_basis(whitening)[0]
    covariances_px2 = np.tile(view.options.dot_sigma_px**2 * np.eye(2), (DOT_COUNT, 1, 1))
    observations = []
    for target in view.target_map.targets:
        independent = sigmas.dots * rng.normal(size=2 * DOT_COUNT)
        modes = sigmas.of_modes * rng.normal(size=6)
        errors = independent + basis @ (modes - basis.T @ independent)
        centres_px = view.camera.camera.project(cam_from_site.apply(target.dots_m))
        centres_px = centres_px + view.options.dot_sigma_px * errors.reshape(DOT_COUNT, 2)
        measured = np.ones(DOT_COUNT, dtype=np.bool_)
        observations.append(TargetObservation(target.code, centres_px, covariances_px2, measured, plate_sigmas=sigmas))
    return observations


def moved(target: MappedTarget, movement: Array) -> MappedTarget:
    """A target after a movement of shape (6,): position (m), small rotation (rad) about its centre, site axes."""
    pose, turn = target.site_from_target, exp_rotation(movement[3:])
    centre_m = pose.position_m + movement[:3]
    dots_m = (target.dots_m - pose.position_m) @ turn.T + centre_m
    return replace(target, site_from_target=Pose(turn @ pose.rotation, centre_m), dots_m=dots_m)


def pose_error(estimate: Pose, truth: Pose) -> Array:
    """Estimate less truth, shape (6,): position (m), small rotation (rad), site axes."""
    turned_rad = log_rotation(estimate.rotation @ truth.rotation.T)
    return np.concatenate([estimate.position_m - truth.position_m, turned_rad])


def _draw_own(target: MappedTarget, rng: np.random.Generator) -> Array:
    return np.asarray(np.sqrt(np.diag(target.covariance)) * rng.normal(size=6))


def _random_target(code: int, site_from_cam: Pose, options: ViewOptions, rng: np.random.Generator) -> MappedTarget:
    """A plate somewhere before the camera, turned towards it but for the incidence."""
    depth_m = options.distance_m * rng.uniform(2.0 / 3.0, 4.0 / 3.0)
    across = rng.uniform(-1.0, 1.0, 2) * [0.7, 0.4]
    centre_cam_m = np.array([*(depth_m * across), depth_m])
    turn = exp_rotation(options.incidence_rad * rng.uniform(0.3, 1.0) * _direction(rng))
    normal = site_from_cam.rotation @ turn @ (-centre_cam_m / np.linalg.norm(centre_cam_m))
    pose = pose_facing(normal, UP, site_from_cam.apply(centre_cam_m), rng.uniform(-np.pi, np.pi))
    covariance = np.diag([options.own_sigma_m**2] * 3 + [options.own_sigma_rad**2] * 3)
    return MappedTarget(code, pose, pose.apply(dots_target_m(DEFAULT_U_M)), covariance, rays=9, rms_px=0.1)


def _direction(rng: np.random.Generator) -> Array:
    vector = rng.normal(size=3)
    return np.asarray(vector / np.linalg.norm(vector))


def _in_view(target: MappedTarget, site_from_cam: Pose, camera: Camera) -> bool:
    cam_m = site_from_cam.inverse().apply(target.dots_m)
    if cam_m[:, 2].min() < LEAST_DEPTH_M:
        return False
    image_px = camera.project(cam_m)
    return bool((image_px > 0).all() and (image_px < [camera.width_px - 1, camera.height_px - 1]).all())
