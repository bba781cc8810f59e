"""A synthetic survey: a small room whose targets, cameras and photographs are known exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.camera import Camera, CameraIdentity
from app.geometry.control import ControlPoint, Role
from app.geometry.observations import Detection, TargetObservation
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.photogrammetry.survey import PlateSpec, SurveyPhoto
from app.targets.layout import DOT_COUNT, PLATE_SIDE_U, cell_of_dot, dots_target_m

Array = npt.NDArray[np.float64]

U_M = 0.014
PLATE = PlateSpec("golay", U_M)
ROOM_M = np.array([6.0, 5.0, 2.6])
NOISE_PX = 0.1
# EXIF says 27 mm: 1437 px by the width convention's prior, 3 % more than the camera has; distortion is not told at all.
IDENTITY = CameraIdentity("Acme", "Phone", 1920, 1080, 4.0, 27.0)
CAMERA = Camera(1920, 1080, np.array([1395.0, 1395.6, 951.0, 547.0, 0.09, -0.19, 0.0006, -0.0009, 0.05]))
OTHER_IDENTITY = CameraIdentity("Bolt", "Tablet", 1600, 1200, 4.4, 28.0)
OTHER_CAMERA = Camera(1600, 1200, np.array([1240.0, 1239.5, 806.0, 590.0, -0.05, 0.08, -0.0004, 0.0005, -0.03]))


@dataclass(frozen=True)
class Room:
    """Targets by code, ``site_from_target`` each, with their dots in the plate frame."""

    poses: dict[int, Pose]
    plates_m: dict[int, Array]

    def dots_m(self, code: int) -> Array:
        return self.poses[code].apply(self.plates_m[code])

    def with_plate(self, code: int, plate_m: Array) -> Room:
        return replace(self, plates_m={**self.plates_m, code: plate_m})

    def with_pose(self, code: int, pose: Pose) -> Room:
        return replace(self, poses={**self.poses, code: pose})


def build_room(per_wall: int = 8, scale_xy: tuple[float, float] = (1.0, 1.0), seed: int = 1) -> Room:
    """Targets on four walls, upright within a few degrees, codes 101, 102, ..."""
    rng = np.random.default_rng(seed)
    x, y, _ = ROOM_M
    walls = [((0, 0), (x, 0), (0, 1)), ((x, 0), (x, y), (-1, 0)), ((x, y), (0, y), (0, -1)), ((0, y), (0, 0), (1, 0))]
    poses: dict[int, Pose] = {}
    for start, end, inwards in walls:
        for place in (np.arange(per_wall) + 0.5) / per_wall:
            floor_m = (1 - place) * np.array(start) + place * np.array(end)
            position_m = np.array([*floor_m, rng.uniform(0.7, 2.3)])
            upright = _facing(np.array([*inwards, 0.0]))
            poses[101 + len(poses)] = Pose(upright @ exp_rotation(rng.normal(0, 0.05, 3)), position_m)
    return Room(poses, {code: dots_target_m(U_M, scale_xy) for code in poses})


def _facing(normal: Array) -> Array:
    """A plate's rotation with its z along the normal and its y up."""
    up = np.array([0.0, 0.0, 1.0])
    return np.stack([np.cross(up, normal), up, normal], axis=-1)


def ring_of_stations(count: int, seed: int = 2) -> tuple[Pose, ...]:
    """``site_from_cam`` of photographs around the room's middle, each looking across it at the opposite walls."""
    rng = np.random.default_rng(seed)
    stations = []
    for angle in 2 * np.pi * np.arange(count) / count:
        outwards = np.array([np.cos(angle), np.sin(angle), 0.0])
        position_m = ROOM_M / 2 + outwards * np.array([1.9, 1.5, 0.0]) + rng.uniform(-0.2, 0.2, 3)
        stations.append(looking(position_m, -outwards + rng.normal(0, 0.15, 3) * [1, 1, 0.3], rng.normal(0, 0.1)))
    return tuple(stations)


def looking(position_m: Array, towards: Array, roll_rad: float = 0.0) -> Pose:
    """A camera pose: z ahead, x to the right, y down."""
    ahead = towards / np.linalg.norm(towards)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(ahead, right), ahead], axis=-1)
    return Pose(rotation @ exp_rotation(np.array([0.0, 0.0, roll_rad])), position_m)


def photograph(
    room: Room,
    station: Pose,
    rng: np.random.Generator,
    camera: Camera = CAMERA,
    noise_px: float = NOISE_PX,
) -> Detection:
    """All targets wholly in view under 70 degrees of incidence; five base dots and most others are measured."""
    targets = []
    for code, pose in room.poses.items():
        dots_m = station.inverse().apply(room.dots_m(code))
        ray_m = station.position_m - pose.position_m
        if dots_m[:, 2].min() < 0.3 or ray_m @ pose.rotation[:, 2] < np.cos(np.deg2rad(70)) * np.linalg.norm(ray_m):
            continue
        dots_px = camera.project(dots_m)
        margin_px = PLATE_SIDE_U
        if (dots_px < margin_px).any() or (dots_px > [camera.width_px - margin_px, camera.height_px - margin_px]).any():
            continue
        measured = rng.random(DOT_COUNT) > 0.3
        measured[[0, 3, 5, 12, 15]] = True
        sigma_px = max(noise_px, 0.01)
        targets.append(
            TargetObservation(
                code,
                dots_px + rng.normal(0, noise_px, dots_px.shape) if noise_px else dots_px,
                np.tile(np.eye(2) * sigma_px**2, (DOT_COUNT, 1, 1)),
                measured,
            )
        )
    return Detection(camera.width_px, camera.height_px, tuple(targets))


def survey_photos(
    room: Room,
    stations: Sequence[Pose],
    seed: int = 3,
    noise_px: float = NOISE_PX,
    identity: CameraIdentity = IDENTITY,
    camera: Camera = CAMERA,
    first: int = 0,
) -> list[SurveyPhoto]:
    """The photographs of one camera, named by number."""
    rng = np.random.default_rng(seed)
    return [
        SurveyPhoto(f"photo{first + number:02d}.jpg", identity, photograph(room, station, rng, camera, noise_px))
        for number, station in enumerate(stations)
    ]


def control_points(
    room: Room,
    dots: Sequence[tuple[int, str]],
    sigma_m: float = 0.001,
    noise_m: float = 0.0,
    role: Role = "control",
    seed: int = 4,
) -> list[ControlPoint]:
    """Points on dots (code, name) of the room."""
    rng = np.random.default_rng(seed)
    points = []
    for code, dot in dots:
        cell = cell_of_dot(dot)
        place_m = room.poses[code].position_m if cell is None else room.dots_m(code)[cell]
        points.append(ControlPoint(f"{role}{code}", code, dot, place_m + rng.normal(0, 1, 3) * noise_m, sigma_m, role))
    return points


# One on each wall, at different heights and places: no symmetry.
CONTROL_DOTS = ((102, "A"), (110, "B"), (117, "C"), (130, "centre"))
CHECK_DOTS = ((104, "E"), (112, "D"), (121, "r1c2"), (126, "A"))


def with_changed(photos: Sequence[SurveyPhoto], name: str, detection: Detection) -> list[SurveyPhoto]:
    """The photographs with another detection in one of them."""
    return [replace(photo, detection=detection) if photo.name == name else photo for photo in photos]


def dot_errors_m(room: Room, target_map_targets: Sequence[object]) -> Array:
    """Published minus true dots, shape (N, 16, 3)."""
    return np.array([target.dots_m - room.dots_m(target.code) for target in target_map_targets])  # type: ignore[attr-defined]
