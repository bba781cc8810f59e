"""Walks for the tests: smooth courses through a room, and what a system with known faults would say of them."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from app.trajectories.trajectory import Array, Trajectory

START_S = 1_760_000_000.0


def walk_at(times_s: Array, covariances: Array | None = None) -> Trajectory:
    """A figure of eight, looking along the path and nodding, at seconds after the start."""
    t = times_s - START_S
    positions_m = np.column_stack([4.0 * np.sin(0.31 * t), 2.0 * np.sin(0.62 * t), 1.5 + 0.2 * np.sin(0.17 * t)])
    angles = np.column_stack([0.4 * t, 0.2 * np.sin(t), 0.1 * np.cos(0.7 * t)])
    return Trajectory(times_s, positions_m, Rotation.from_euler("zyx", angles).as_quat(canonical=True), covariances)


def walk(duration_s: float = 60.0, rate_hz: float = 10.0, **given: Array) -> Trajectory:
    return walk_at(START_S + np.arange(0.0, duration_s, 1.0 / rate_hz), **given)


def noisy(trajectory: Trajectory, sigma_m: float, seed: int = 1) -> Trajectory:
    noise_m = np.random.default_rng(seed).normal(0.0, sigma_m, trajectory.positions_m.shape)
    return Trajectory(trajectory.times_s, trajectory.positions_m + noise_m, trajectory.orientations_xyzw)
