"""What a sensor that is read row by row sees while its camera moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.geometry.observations import TargetObservation
from app.geometry.readout import Readout
from app.geometry.rotation import exp_rotation
from tests.photogrammetry.resection_scene import DOT_SIGMA_PX, Scene, observe

Array = npt.NDArray[np.float64]

READOUT = Readout(0.025)
FIXED_POINT_STEPS = 6  # a dot's row decides when it is seen, and when it is seen decides its row


def observe_moving(
    scene: Scene, motion: Array, rng: np.random.Generator, readout: Readout = READOUT
) -> list[TargetObservation]:
    """The scene seen while the camera moves at a velocity and an angular velocity, shape (6,), site axes."""
    camera, pose = scene.camera.camera, scene.site_from_cam
    noisy, exact, seen = observe(scene, rng, DOT_SIGMA_PX), observe(scene), []
    for with_noise, still, target in zip(noisy, exact, scene.target_map.targets, strict=True):
        dots_px = still.centres_px
        for _ in range(FIXED_POINT_STEPS):
            times_s = readout.times_s(dots_px, camera.width_px, camera.height_px)[:, None]
            rotations = exp_rotation(times_s * motion[3:]) @ pose.rotation
            from_cam_m = target.dots_m - pose.position_m - times_s * motion[:3]
            dots_px = camera.project((np.swapaxes(rotations, -1, -2) @ from_cam_m[..., None])[..., 0])
        seen.append(replace(with_noise, centres_px=dots_px + with_noise.centres_px - still.centres_px))
    return seen


def random_motion(rng: np.random.Generator, speed_m_s: float, turn_rad_s: float) -> Array:
    """A movement of these speeds in directions at random, shape (6,)."""
    directions = rng.normal(size=(2, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return np.concatenate([speed_m_s * directions[0], turn_rad_s * directions[1]])
