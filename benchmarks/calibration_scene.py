"""What phones see of the demonstration room, without pixels: dots with noise, in motion too, and a map that errs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.camera import Camera
from app.geometry.observations import Detection, TargetObservation
from app.geometry.pose import Pose
from app.geometry.readout import Readout
from app.geometry.rotation import exp_rotation
from app.geometry.target_map import MappedTarget, TargetMap
from app.planning.scene import Scene
from app.planning.sight import see
from app.targets.layout import DOT_COUNT
from benchmarks.pose_scene import NO_DATUM, moved

Array = npt.NDArray[np.float64]

DOT_SIGMA_PX = 0.08  # of a dot of 6 px diameter, as the detector has it in room-a
OWN_SIGMAS = np.array([2e-4] * 3 + [6e-4] * 3)  # of a target in the map of a survey of 54 photographs: m, rad
FIXED_POINT_STEPS = 6  # a dot's row decides when it is seen, and when it is seen decides its row
RAYS, RMS_PX = 9, 0.1


@dataclass(frozen=True)
class Walk:
    """A movement during a readout: velocity (m/s), angular velocity (rad/s), site axes, shape (6,)."""

    motion: Array
    readout: Readout


def true_map(scene: Scene, u_m: float) -> TargetMap:
    """The targets where they hang, as a survey knows them."""
    own = np.diag(OWN_SIGMAS**2)
    targets = tuple(
        MappedTarget(target.code, target.site_from_target, target.dots_m(), own, RAYS, RMS_PX)
        for target in scene.targets
    )
    return TargetMap(targets, NO_DATUM, "golay", u_m)


def redrawn(target_map: TargetMap, rng: np.random.Generator) -> TargetMap:
    """The map with errors of its own covariance."""
    return replace(
        target_map, targets=tuple(moved(target, OWN_SIGMAS * rng.normal(size=6)) for target in target_map.targets)
    )


def observe(scene: Scene, camera: Camera, pose: Pose, rng: np.random.Generator, walk: Walk | None = None) -> Detection:
    """What the camera sees wholly, with noise; in motion when it walks."""
    dots_m = {target.code: target.dots_m() for target in scene.targets}
    targets = []
    for seen in see(scene, camera, pose):
        if not seen.whole:
            continue
        dots_px = seen.dots_px if walk is None else _in_motion(dots_m[seen.code], camera, pose, walk)
        noisy_px = dots_px + rng.normal(0.0, DOT_SIGMA_PX, dots_px.shape)
        covariances_px2 = np.tile(DOT_SIGMA_PX**2 * np.eye(2), (DOT_COUNT, 1, 1))
        targets.append(TargetObservation(seen.code, noisy_px, covariances_px2, np.ones(DOT_COUNT, dtype=np.bool_)))
    return Detection(camera.width_px, camera.height_px, tuple(targets))


def random_walk(rng: np.random.Generator, speed_m_s: float, turn_rad_s: float, readout: Readout) -> Walk:
    """These speeds in directions at random."""
    directions = rng.normal(size=(2, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return Walk(np.concatenate([speed_m_s * directions[0], turn_rad_s * directions[1]]), readout)


def breathing(camera: Camera, share: float, rng: np.random.Generator) -> Camera:
    """The camera at the focus of a moment."""
    intrinsics = camera.intrinsics.copy()
    intrinsics[:2] *= 1.0 + share * rng.normal()
    return camera.with_intrinsics(intrinsics)


def _in_motion(dots_m: Array, camera: Camera, pose: Pose, walk: Walk) -> Array:
    """Images of dots, shape (16, 2), each from where the camera is when its row is read."""
    dots_px = camera.project(pose.inverse().apply(dots_m))
    for _ in range(FIXED_POINT_STEPS):
        times_s = walk.readout.times_s(dots_px, camera.width_px, camera.height_px)[:, None]
        rotations = exp_rotation(times_s * walk.motion[3:]) @ pose.rotation
        from_cam_m = dots_m - pose.position_m - times_s * walk.motion[:3]
        dots_px = camera.project((np.swapaxes(rotations, -1, -2) @ from_cam_m[..., None])[..., 0])
    return dots_px
