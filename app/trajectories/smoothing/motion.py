"""How a walker moves on: an even velocity, shaken by white noise, in position and in rotation apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.geometry.rotation import exp_rotation, log_rotation, skew
from app.trajectories.trajectory import Array

POSE, STATE = 6, 12  # errors of position and rotation; with those of their velocities


@dataclass(frozen=True)
class MotionOptions:
    """The liveliness of a walker who holds a phone.

    Attributes
    ----------
    acceleration_m_s2_rt_hz : float
        Square root of the spectral density of the white acceleration: 1 m/s^2 that lasts a third of a second, half a
        step, makes sqrt(1/3) = 0.6.
    turning_rad_s2_rt_hz : float
        The same of rotation: 2 rad/s^2 that last a quarter of a second make 1.0.
    speed_m_s, rate_rad_s : float
        Standard deviations of the velocities before anything is known: a brisk walk, a quick turn.
    """

    acceleration_m_s2_rt_hz: float = 0.6
    turning_rad_s2_rt_hz: float = 1.0
    speed_m_s: float = 1.5
    rate_rad_s: float = 2.0

    @property
    def densities(self) -> Array:
        """Spectral densities of the six components, shape (6,)."""
        return np.repeat([self.acceleration_m_s2_rt_hz**2, self.turning_rad_s2_rt_hz**2], 3)

    @property
    def first_variances(self) -> Array:
        """Variances of the six velocities at the start, shape (6,)."""
        return np.repeat([self.speed_m_s**2, self.rate_rad_s**2], 3)


@dataclass(frozen=True)
class State:
    """Where a walker is and how he moves, with the covariance of the 12 errors.

    Attributes
    ----------
    position_m, velocity_m_s : ndarray of shape (3,)
    rotation : ndarray of shape (3, 3)
        site_from_cam.
    rate_rad_s : ndarray of shape (3,)
        Angular velocity in site axes.
    covariance : ndarray of shape (12, 12)
        Errors of position, small rotation (``R_true = Exp(dtheta) R``), velocity, rate; site axes.
    """

    position_m: Array
    rotation: Array
    velocity_m_s: Array
    rate_rad_s: Array
    covariance: Array

    def plus(self, change: Array, covariance: Array) -> State:
        """The state moved by 12 small numbers."""
        return State(
            self.position_m + change[:3],
            exp_rotation(change[3:6]) @ self.rotation,
            self.velocity_m_s + change[6:9],
            self.rate_rad_s + change[9:],
            covariance,
        )

    def minus(self, other: State) -> Array:
        """The 12 small numbers that take the other state to this one."""
        turn = log_rotation(self.rotation @ other.rotation.T)
        return np.concatenate(
            [
                self.position_m - other.position_m,
                turn,
                self.velocity_m_s - other.velocity_m_s,
                self.rate_rad_s - other.rate_rad_s,
            ]
        )


def predict(state: State, step_s: float, options: MotionOptions) -> tuple[State, Array]:
    """The state a while later, and the transition of the errors, shape (12, 12).

    Notes
    -----
    ``Exp((w + dw) t) = Exp(J dw t) Exp(w t)`` with the left Jacobian J (Barfoot, State Estimation for Robotics, 2017,
    equation 7.77); the noise is that of a twice integrated white one (Bar-Shalom et al., Estimation with Applications
    to Tracking and Navigation, 2001, section 6.2.2), which takes the walker's rotation within a step for small.
    """
    turn_rad = state.rate_rad_s * step_s
    moved = exp_rotation(turn_rad)
    transition = np.eye(STATE)
    transition[:3, 6:9] = step_s * np.eye(3)
    transition[3:6, 3:6] = moved
    transition[3:6, 9:] = step_s * left_jacobian(turn_rad)
    covariance = transition @ state.covariance @ transition.T + _noise(step_s, options.densities)
    position_m = state.position_m + step_s * state.velocity_m_s
    return State(position_m, moved @ state.rotation, state.velocity_m_s, state.rate_rad_s, covariance), transition


def _noise(step_s: float, densities: Array) -> Array:
    weights = np.array([[step_s**3 / 3.0, step_s**2 / 2.0], [step_s**2 / 2.0, step_s]])
    return np.kron(weights, np.diag(densities))


def left_jacobian(rotation_rad: Array) -> Array:
    """Left Jacobian of SO(3), shape (3, 3), of a rotation vector: ``Exp(a + b) = Exp(J(a) b) Exp(a)`` for small b."""
    theta = float(np.linalg.norm(rotation_rad))
    cross = skew(rotation_rad)
    if theta < 1e-4:  # the series, exact to 1e-17 there
        return np.eye(3) + cross / 2.0 + cross @ cross / 6.0
    return np.eye(3) + (1.0 - np.cos(theta)) / theta**2 * cross + (theta - np.sin(theta)) / theta**3 * (cross @ cross)
