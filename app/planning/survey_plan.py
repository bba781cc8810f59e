"""A whole synthetic survey: a room, a camera, stations to photograph from, control points with noise; and the truth."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.geometry.camera import Camera
from app.geometry.control import ControlPoint, Role
from app.geometry.pose import Pose
from app.planning.imaging import ImagingOptions
from app.planning.posting import UP, RoomOptions
from app.planning.room import build_room
from app.planning.scene import PostedTarget, Scene
from app.planning.synthetic import RenderedPhoto, render
from app.targets.family import CodeFamily
from app.targets.layout import BASE_CELLS, BASE_NAMES

Floats = npt.NDArray[np.float64]

# A phone's main camera in a 4:3 frame: 68 degrees across, a mild wave of distortion.
FOCAL_SHARE = 0.74  # of the width
PRINCIPAL_SHARE = (0.004, -0.006)  # of the width, away from the middle
DISTORTION = (0.08, -0.16, 5e-4, -4e-4, 0.06)

SMALL_ROOM_STATIONS = 12
SMALL_ROOM_AIMS_M = np.array([[0.1, 1.6, 1.3], [0.6, 0.6, 1.3], [1.6, 0.1, 1.3]])
SEEDS_PER_PHOTO = 1_000_003  # a prime: noise of different photographs and surveys comes from different seeds


@dataclass(frozen=True)
class StationOptions:
    """Where the photographs are taken from.

    Attributes
    ----------
    count : int
        Photographs.
    height_m : float
        Of a phone held before the chest; it varies by ``height_jitter_m``.
    height_jitter_m : float
    ring_share : float
        Stations stand on an ellipse whose half axes are this share of the room's, and look across its middle, so that
        rays meet at wide angles.
    aim_jitter_rad : float
        Standard deviation of where they look, across and up.
    upright_every : int
        Every so many photographs the phone is held upright (a quarter turn), which a self-calibration needs.
    """

    count: int = 12
    height_m: float = 1.45
    height_jitter_m: float = 0.15
    ring_share: float = 0.6
    aim_jitter_rad: float = 0.12
    upright_every: int = 4


@dataclass(frozen=True)
class SurveyPlan:
    """A synthetic survey, photographed on demand.

    Attributes
    ----------
    scene : Scene
        Its targets' poses are the truth.
    camera : Camera
        The true intrinsics.
    stations : tuple of Pose
        The true ``site_from_cam`` of each photograph.
    control : tuple of ControlPoint
        As a surveyor would hand them in, with noise.
    imaging : ImagingOptions
    seed : int
    """

    scene: Scene
    camera: Camera
    stations: tuple[Pose, ...]
    control: tuple[ControlPoint, ...]
    imaging: ImagingOptions
    seed: int

    def photograph(self, index: int) -> RenderedPhoto:
        """The photograph from a station; each has its own noise and its own time, a second after the last."""
        captured_at = f"2026:01:01 12:{index // 60 % 60:02d}:{index % 60:02d}"
        imaging = replace(self.imaging, captured_at=captured_at)
        return render(self.scene, self.camera, self.stations[index], imaging, self.seed * SEEDS_PER_PHOTO + index)


def phone_camera(width_px: int, height_px: int) -> Camera:
    """A typical phone's main camera for a frame of that size."""
    long_px = max(width_px, height_px)
    focal_px = FOCAL_SHARE * long_px
    centre_px = np.array([width_px - 1, height_px - 1]) / 2 + np.array(PRINCIPAL_SHARE) * long_px
    return Camera(width_px, height_px, np.array([focal_px, focal_px, *centre_px, *DISTORTION]))


def look_at(position_m: Floats, aim_m: Floats, roll_rad: float = 0.0) -> Pose:
    """Pose ``site_from_cam`` at a position, looking at a point; the roll turns the camera clockwise about its view.

    Raises
    ------
    ValueError
        When it would look straight up or down: there is no upright then.
    """
    forward = (aim_m - position_m) / np.linalg.norm(aim_m - position_m)
    right = np.cross(forward, UP)
    if np.linalg.norm(right) < np.finfo(np.float32).eps:
        raise ValueError("a camera that looks straight up or down has no upright: aim it a little aside")
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    cosine, sine = np.cos(roll_rad), np.sin(roll_rad)
    rotation = np.column_stack([cosine * right + sine * down, cosine * down - sine * right, forward])
    return Pose(rotation, np.asarray(position_m, dtype=np.float64))


def plan_stations(size_m: tuple[float, float, float], options: StationOptions, seed: int) -> tuple[Pose, ...]:
    """Poses on an ellipse about the middle of a room, each looking across it, a little aside."""
    rng = np.random.default_rng(seed)
    middle_m = np.array([size_m[0] / 2, size_m[1] / 2, options.height_m])
    stations = []
    for index in range(options.count):
        angle_rad = 2.0 * np.pi * index / options.count
        arm_m = options.ring_share * middle_m[:2] * [np.cos(angle_rad), np.sin(angle_rad)]
        position_m = middle_m + np.append(arm_m, rng.normal(0.0, options.height_jitter_m))
        aside_rad, up_rad = rng.normal(0.0, options.aim_jitter_rad, 2)
        heading_rad = np.arctan2(-arm_m[1], -arm_m[0]) + aside_rad
        aim = np.array([np.cos(heading_rad), np.sin(heading_rad), np.tan(up_rad)])
        upright = options.upright_every > 0 and index % options.upright_every == options.upright_every - 1
        stations.append(look_at(position_m, position_m + aim, np.pi / 2 if upright else 0.0))
    return tuple(stations)


def survey_control(
    targets: tuple[PostedTarget, ...], counts: tuple[int, int], sigma_m: float, seed: int
) -> tuple[ControlPoint, ...]:
    """Control and check points on base dots of targets that lie far apart, with normal noise.

    Parameters
    ----------
    targets : tuple of PostedTarget
        Those of wrong structure are passed over.
    counts : tuple of int
        How many control and how many check points.
    sigma_m : float
        Standard deviation of each coordinate.
    seed : int

    Raises
    ------
    InvalidInput
        When there are fewer targets than points.
    """
    rng = np.random.default_rng(seed)
    usable = [target for target in targets if not target.wrong]
    if len(usable) < sum(counts):
        raise InvalidInput(f"{sum(counts)} points need as many targets, there are {len(usable)}: post more targets")
    chosen = farthest_first(np.stack([target.site_from_target.position_m for target in usable]), sum(counts))
    points = []
    for index, at in enumerate(chosen):
        role: Role = "control" if index < counts[0] else "check"
        dot = index % len(BASE_CELLS)
        position_m = usable[at].dots_m()[BASE_CELLS[dot]] + rng.normal(0.0, sigma_m, 3)
        points.append(ControlPoint(f"P{index + 1}", usable[at].code, BASE_NAMES[dot], position_m, sigma_m, role))
    return tuple(points)


def farthest_first(points_m: Floats, count: int) -> list[int]:
    """Indices of points that lie far from each other: each next one is the farthest from all before it."""
    chosen = [int(np.linalg.norm(points_m - points_m.mean(axis=0), axis=1).argmax())]
    while len(chosen) < count:
        distances_m = np.linalg.norm(points_m[:, None] - points_m[chosen], axis=2).min(axis=1)
        chosen.append(int(distances_m.argmax()))
    return chosen


def small_room(family: CodeFamily, seed: int = 1) -> SurveyPlan:
    """A corner cheap enough to be photographed in a test: 12 targets of u = 20 mm, 12 stations, 640 x 480.

    The targets hang on the two walls of one corner; the stations stand on an arc before it and look at one wall, the
    corner and the other wall in turn, so that each target is seen from several of them.
    """
    room = RoomOptions((2.6, 2.6, 2.4), targets=12, u_m=0.02, heights_m=(0.7, 1.9), walls=(0, 3), furniture=False)
    scene = build_room(room, family, seed)
    rng = np.random.default_rng(seed)
    stations = []
    for index, bearing_rad in enumerate(np.radians(np.linspace(30.0, 60.0, SMALL_ROOM_STATIONS))):
        position_m = 2.6 * np.array([np.cos(bearing_rad), np.sin(bearing_rad), 0.0])
        position_m[2] = rng.uniform(1.1, 1.7)
        aim_m = SMALL_ROOM_AIMS_M[index % len(SMALL_ROOM_AIMS_M)] + rng.normal(0.0, 0.1, 3)
        stations.append(look_at(position_m, aim_m, np.pi / 2 if index % 6 == 4 else 0.0))
    control = survey_control(scene.targets, (4, 4), 0.0005, seed)
    return SurveyPlan(scene, phone_camera(640, 480), tuple(stations), control, ImagingOptions(), seed)
