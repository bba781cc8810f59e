"""How a camera moved while its sensor was read: at a constant velocity, which is known to be that of a person."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

MOTION_COUNT = 6


@dataclass(frozen=True)
class MotionOptions:
    """What is supposed of the movement before it is seen.

    Attributes
    ----------
    speed_m_s : float
        Standard deviation of each coordinate of the velocity: people walk at 1.0 to 1.4 m/s (Bohannon and Andrews,
        Physiotherapy 97, 2011) and run at three times that.
    turn_rad_s : float
        Standard deviation of each coordinate of the angular velocity: a quarter turn in a second and a half.
    max_spread_m : float
        Standard deviation of the position that the movement may leave; beyond it one plate's tilt and the shear of a
        picture in motion are told apart no more, and the linear covariance flatters.
    most_steps : int
        Gauss-Newton steps; the equations are nearly linear and take three.
    converged_sigmas : float
        The last step is shorter than this many standard deviations.
    rounds : int
        Estimates of the movement, at least one; the second from the targets that agree after the first.
    """

    speed_m_s: float = 1.0
    turn_rad_s: float = 1.0
    max_spread_m: float = 0.1
    most_steps: int = 10
    converged_sigmas: float = 0.01
    rounds: int = 2

    def __post_init__(self) -> None:
        if self.rounds < 1 or min(self.speed_m_s, self.turn_rad_s) <= 0:
            raise ValueError("a movement is estimated once at least, and supposed to be possible")

    @property
    def sigmas(self) -> Array:
        """Of the six coordinates, shape (6,): m/s, rad/s."""
        return np.array([self.speed_m_s] * 3 + [self.turn_rad_s] * 3)


@dataclass(frozen=True)
class Motion:
    """A movement during a readout.

    Attributes
    ----------
    velocity_m_s : ndarray of shape (3,)
        Of the projection centre, site axes.
    angular_velocity_rad_s : ndarray of shape (3,)
        Site axes: ``R(t) = Exp(t angular_velocity) R(0)``.
    covariance : ndarray of shape (6, 6)
        Velocity (m/s), angular velocity (rad/s).
    """

    velocity_m_s: Array
    angular_velocity_rad_s: Array
    covariance: Array

    @property
    def values(self) -> Array:
        """Both, shape (6,)."""
        return np.concatenate([self.velocity_m_s, self.angular_velocity_rad_s])
