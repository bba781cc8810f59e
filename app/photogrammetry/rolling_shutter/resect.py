"""A snapshot in motion to a pose: find who agrees, estimate the movement, take it out, resect as if it had been still.

The pose is that of the middle of the picture. Its covariance holds what the movement leaves uncertain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated
from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera
from app.geometry.observations import TargetObservation
from app.geometry.plate_sigmas import PlateSigmas
from app.geometry.readout import Readout
from app.geometry.target_map import TargetMap
from app.photogrammetry.resection import Resection, ResectionOptions, resect
from app.photogrammetry.resection_equations import POSE_COUNT, STATE_COUNT, CameraPrior, State
from app.photogrammetry.resection_input import SightedTargets, sight_targets
from app.photogrammetry.resection_refusals import undetermined
from app.photogrammetry.rolling_shutter.equations import MOTION, Moving, moving_rows, normal_equations
from app.photogrammetry.rolling_shutter.motion import MOTION_COUNT, Motion, MotionOptions
from app.targets.layout import DOT_COUNT, dot_centres_u

Array = npt.NDArray[np.float64]

ROOT_DOTS = float(np.sqrt(DOT_COUNT))  # an orthonormal shift of sixteen dots by one each


@dataclass(frozen=True)
class MovingResection:
    """A pose, and the movement that was taken out of the observations; None when the readout is not known.

    Attributes
    ----------
    resection : Resection
    observations : tuple of TargetObservation
        As a still camera would have made them; what was seen, where no movement was estimated.
    motion : Motion or None
    """

    resection: Resection
    observations: tuple[TargetObservation, ...]
    motion: Motion | None = None


@dataclass(frozen=True)
class _Estimate:
    """A movement, and what its uncertainty adds to the pose's covariance, shape (6, 6)."""

    moving: Moving
    motion: Motion
    spread: Array


@dataclass(frozen=True)
class _Snapshot:
    """What stays the same."""

    target_map: TargetMap
    camera: CalibratedCamera
    readout: Readout
    options: ResectionOptions
    motion: MotionOptions

    def resect(self, observations: Sequence[TargetObservation]) -> Resection:
        """As if it had been still."""
        return resect(observations, self.target_map, self.camera, self.options)

    def times_s(self, image_px: Array) -> Array:
        """Exposure of image points relative to the middle of the picture."""
        return self.readout.times_s(image_px, self.camera.camera.width_px, self.camera.camera.height_px)


def resect_moving(
    observations: Sequence[TargetObservation],
    target_map: TargetMap,
    camera: CalibratedCamera,
    options: ResectionOptions | None = None,
    motion: MotionOptions | None = None,
) -> MovingResection:
    """Pose of a photograph whose camera may have moved while it was read.

    Parameters
    ----------
    observations, target_map, camera, options
        As ``resect``; a camera without a readout is taken as still.
    motion : MotionOptions, optional

    Raises
    ------
    NotLocated
        As ``resect``.
    """
    options, motion = options or ResectionOptions(), motion or MotionOptions()
    if camera.readout is None or camera.readout.duration_s == 0.0:
        return MovingResection(resect(observations, target_map, camera, options), tuple(observations))
    snapshot = _Snapshot(target_map, camera, camera.readout, options, motion)
    found = _first(snapshot, observations)
    for _ in range(motion.rounds):
        estimate = _estimate(snapshot, observations, found)
        stilled = _stilled(snapshot, observations, estimate)
        found = snapshot.resect(stilled)
    sigma_m = float(np.sqrt(np.trace(estimate.spread[:3, :3])))
    if sigma_m > motion.max_spread_m:
        raise undetermined(sigma_m, motion.max_spread_m)
    return MovingResection(replace(found, covariance=found.covariance + estimate.spread), stilled, estimate.motion)


def _first(snapshot: _Snapshot, observations: Sequence[TargetObservation]) -> Resection:
    """A pose and the targets that agree on it as far as a moving camera lets them."""
    try:
        return snapshot.resect([_loosened(snapshot, seen) for seen in observations])
    except NotLocated:
        return snapshot.resect(observations)


def _loosened(snapshot: _Snapshot, seen: TargetObservation) -> TargetObservation:
    """An observation that may be shifted and sheared by what a movement shifts and shears its plate."""
    focal_px, dots_px = snapshot.camera.camera.fx_px, seen.centres_px
    size_u = dot_centres_u()
    px_per_u = float(
        np.sqrt(((dots_px - dots_px.mean(axis=0)) ** 2).sum() / ((size_u - size_u.mean(axis=0)) ** 2).sum())
    )
    distance_m = focal_px * snapshot.target_map.u_m / px_per_u
    speed_px_s = focal_px * np.hypot(snapshot.motion.turn_rad_s, snapshot.motion.speed_m_s / distance_m)
    times_s = snapshot.times_s(dots_px)
    sigma_px = float(np.sqrt(np.trace(seen.covariances_px2[seen.measured].mean(axis=0)) / 2.0))
    shift = ROOT_DOTS * speed_px_s * abs(float(times_s.mean())) / sigma_px
    shear = ROOT_DOTS * speed_px_s * float(times_s.std()) / sigma_px
    own = seen.plate_sigmas
    return replace(
        seen,
        plate_sigmas=PlateSigmas(float(np.hypot(own.shift, shift)), float(np.hypot(own.linear, shear)), own.dots),
    )


def _estimate(snapshot: _Snapshot, observations: Sequence[TargetObservation], found: Resection) -> _Estimate:
    """The movement that explains the targets which agree."""
    used = {target.code for target in found.targets if target.used}
    sighted = sight_targets([seen for seen in observations if seen.code in used], snapshot.target_map)
    prior, times_s = CameraPrior.of(snapshot.camera), snapshot.times_s(sighted.observed_px)
    at = Moving(State(found.site_from_cam, np.zeros(INTRINSIC_COUNT)), np.zeros(MOTION_COUNT))
    for _ in range(snapshot.motion.most_steps):
        rows = moving_rows(sighted, prior, at, times_s)
        information, gradient = normal_equations(sighted, rows, at, snapshot.motion.sigmas)
        step = np.asarray(-np.linalg.solve(information, gradient), dtype=np.float64)
        at = at.moved(step)
        if step @ information @ step < snapshot.motion.converged_sigmas**2:
            break
    return _with_covariances(at, information)


def _with_covariances(at: Moving, information: Array) -> _Estimate:
    """The movement's covariance, and by how much the pose's grows as the movement is not known exactly."""
    joint = np.asarray(np.linalg.inv(information), dtype=np.float64)
    still = np.linalg.inv(information[:STATE_COUNT, :STATE_COUNT])
    spread = joint[:POSE_COUNT, :POSE_COUNT] - still[:POSE_COUNT, :POSE_COUNT]
    motion = Motion(at.motion[:3], at.motion[3:], joint[MOTION, MOTION])
    return _Estimate(at, motion, (spread + spread.T) / 2.0)


def _stilled(
    snapshot: _Snapshot, observations: Sequence[TargetObservation], estimate: _Estimate
) -> tuple[TargetObservation, ...]:
    """The observations as a camera that stood still would have made them; those of unknown targets as they are."""
    known = [seen for seen in observations if seen.code in snapshot.target_map.by_code]
    sighted = sight_targets(known, snapshot.target_map)
    shifts_px = _shifts_px(snapshot, sighted, estimate.moving)
    moved = {
        seen.code: replace(seen, centres_px=seen.centres_px - shift_px)
        for seen, shift_px in zip(known, shifts_px, strict=True)
    }
    return tuple(moved.get(seen.code, seen) for seen in observations)


def _shifts_px(snapshot: _Snapshot, sighted: SightedTargets, at: Moving) -> Array:
    """By how much the movement shifts the dots, shape (K, 16, 2)."""
    prior, times_s = CameraPrior.of(snapshot.camera), snapshot.times_s(sighted.observed_px)
    moving = moving_rows(sighted, prior, at, times_s).computed_px
    return np.asarray(moving - moving_rows(sighted, prior, at, np.zeros_like(times_s)).computed_px)
