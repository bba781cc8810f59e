"""A walk with a phone in the hand: where it is at any moment, smooth as a person's, never quite steady."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d

from app.geometry.pose import Pose
from app.planning.survey_plan import look_at

Floats = npt.NDArray[np.float64]

STEADY_HZ = 100.0  # samples of the path in between which it is straight
STEP_HZ = 1.8  # a walker's steps; the body rises with each and sways to one side every other
GREATEST_PITCH_RAD = np.radians(80.0)  # nobody holds a phone straight up or down, and there it has no upright


@dataclass(frozen=True)
class WalkOptions:
    """How somebody walks and holds the phone.

    Attributes
    ----------
    speed_m_s : float
        Along the path; 1.4 is brisk, 0.8 looks about.
    turn_s : float
        Standard deviation of the time over which corners are rounded.
    rise_m, sway_m : float
        Amplitude of the body's movement up and down and to either side.
    unsteady_rad : float
        Standard deviation of the hand's turns about each axis.
    unsteady_s : float
        Time over which they change.
    """

    speed_m_s: float = 1.0
    turn_s: float = 0.6
    rise_m: float = 0.015
    sway_m: float = 0.015
    unsteady_rad: float = float(np.radians(1.5))
    unsteady_s: float = 0.4

    def __post_init__(self) -> None:
        if not (self.speed_m_s > 0 and self.turn_s > 0 and self.unsteady_s > 0):
            raise ValueError("a walk has a positive speed and takes time for its turns")


@dataclass(frozen=True)
class Gaze:
    """Where the walker points the phone.

    Attributes
    ----------
    at_m : ndarray of shape (3,) or None
        A place that stays in the middle of the picture; None looks ahead.
    aside_rad, up_rad : float
        From straight ahead to the left, and up.
    roll_rad : float
        A quarter turn holds the phone upright.
    """

    at_m: Floats | None = None
    aside_rad: float = 0.0
    up_rad: float = 0.0
    roll_rad: float = 0.0


@dataclass(frozen=True)
class Walk:
    """The phone's place and direction over time, as samples that are joined by straight lines.

    Attributes
    ----------
    times_s : ndarray of shape (N,)
        From the walk's start.
    positions_m : ndarray of shape (N, 3)
    angles_rad : ndarray of shape (N, 3)
        Heading (counter-clockwise from x, unwrapped), elevation and roll.
    """

    times_s: Floats
    positions_m: Floats
    angles_rad: Floats

    @property
    def duration_s(self) -> float:
        """From start to end."""
        return float(self.times_s[-1])

    def pose_at(self, time_s: float) -> Pose:
        """``site_from_cam`` so many seconds after the start; before it and past the end the phone stands still."""
        position_m = np.array([np.interp(time_s, self.times_s, axis) for axis in self.positions_m.T])
        heading, up, roll = (float(np.interp(time_s, self.times_s, axis)) for axis in self.angles_rad.T)
        ahead = np.array([np.cos(heading) * np.cos(up), np.sin(heading) * np.cos(up), np.sin(up)])
        return look_at(position_m, position_m + ahead, roll)


def plan_walk(waypoints_m: Floats, gaze: Gaze, options: WalkOptions, seed: int) -> Walk:
    """Walk from waypoint to waypoint, shape (N, 3), N >= 2, no two that follow each other the same.

    Raises
    ------
    ValueError
        When there is no way to walk.
    """
    if len(waypoints_m) < 2:
        raise ValueError("a walk has two waypoints or more")
    legs_m = np.linalg.norm(np.diff(waypoints_m, axis=0), axis=1)
    if not (legs_m > 0).all():
        raise ValueError("two waypoints that follow each other are the same place")
    passed_s = np.append(0.0, np.cumsum(legs_m)) / options.speed_m_s
    times_s = np.arange(int(np.ceil(passed_s[-1] * STEADY_HZ)) + 1) / STEADY_HZ
    straight_m = np.column_stack([np.interp(times_s, passed_s, axis) for axis in waypoints_m.T])
    path_m = _smooth(straight_m, options.turn_s)
    course_rad = _course(path_m, options.turn_s)
    rng = np.random.default_rng(seed)
    positions_m = path_m + _steps(times_s, course_rad, options, rng)
    return Walk(times_s, positions_m, _angles(positions_m, course_rad, gaze) + _unsteady(len(times_s), options, rng))


def _course(path_m: Floats, turn_s: float) -> Floats:
    """Heading of the movement, shape (N,), unwrapped."""
    step_m = np.gradient(path_m, axis=0)
    return _smooth(np.unwrap(np.arctan2(step_m[:, 1], step_m[:, 0])), turn_s)


def _angles(positions_m: Floats, course_rad: Floats, gaze: Gaze) -> Floats:
    heading_rad, up_rad = course_rad + gaze.aside_rad, np.full(len(course_rad), gaze.up_rad)
    if gaze.at_m is not None:
        way_m = gaze.at_m - positions_m
        heading_rad = np.unwrap(np.arctan2(way_m[:, 1], way_m[:, 0]))
        up_rad = np.arctan2(way_m[:, 2], np.hypot(way_m[:, 0], way_m[:, 1]))
    up_rad = np.clip(up_rad, -GREATEST_PITCH_RAD, GREATEST_PITCH_RAD)
    return np.column_stack([heading_rad, up_rad, np.full(len(course_rad), gaze.roll_rad)])


def _steps(times_s: Floats, course_rad: Floats, options: WalkOptions, rng: np.random.Generator) -> Floats:
    """The body's rise and sway, shape (N, 3)."""
    rise, sway = rng.uniform(0.0, 2.0 * np.pi, 2)
    aside_m = options.sway_m * np.sin(np.pi * STEP_HZ * times_s + sway)
    up_m = options.rise_m * np.sin(2.0 * np.pi * STEP_HZ * times_s + rise)
    return np.column_stack([-np.sin(course_rad) * aside_m, np.cos(course_rad) * aside_m, up_m])


def _unsteady(count: int, options: WalkOptions, rng: np.random.Generator) -> Floats:
    """Turns of the hand about its three axes, shape (count, 3), of the wished standard deviation."""
    # A Gaussian window of s samples leaves white noise 1 / (2 sqrt(pi) s) of its variance.
    samples = options.unsteady_s * STEADY_HZ
    gain = np.sqrt(2.0 * np.sqrt(np.pi) * samples)
    return options.unsteady_rad * gain * _smooth(rng.standard_normal((count, 3)), options.unsteady_s)


def _smooth(values: Floats, sigma_s: float) -> Floats:
    return np.asarray(gaussian_filter1d(values, sigma_s * STEADY_HZ, axis=0, mode="nearest"))
