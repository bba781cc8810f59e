"""A mapped room, and a phone that calibrates itself in it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from app.geometry.camera import Camera, CameraIdentity
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.geometry.target_map import MappedTarget, TargetMap
from app.photogrammetry.survey import SurveyPhoto
from tests.photogrammetry.resection_scene import NO_DATUM, OWN_SIGMAS, redrawn_map
from tests.photogrammetry.survey_scene import (
    CAMERA,
    IDENTITY,
    U_M,
    Room,
    build_room,
    photograph,
    ring_of_stations,
)

ROOM = build_room()
QUARTER_TURN_RAD = np.pi / 2


def surveyed_map(seed: int = 0, room: Room = ROOM) -> TargetMap:
    """A map of the room that errs as its covariances say."""
    own = np.diag(OWN_SIGMAS**2)
    targets = tuple(
        MappedTarget(code, pose, room.dots_m(code), own, rays=9, rms_px=0.1) for code, pose in room.poses.items()
    )
    return redrawn_map(TargetMap(targets, NO_DATUM, "golay", U_M), np.random.default_rng(seed))


def stations(count: int, seed: int = 5) -> tuple[Pose, ...]:
    """Around the room, every third with the phone turned by a quarter."""
    turn = exp_rotation(np.array([0.0, 0.0, QUARTER_TURN_RAD]))
    upright = ring_of_stations(count, seed)
    return tuple(
        Pose(pose.rotation @ turn, pose.position_m) if index % 3 == 0 else pose for index, pose in enumerate(upright)
    )


def shots(
    places: Sequence[Pose],
    camera_of: Callable[[int], Camera] = lambda _: CAMERA,
    identity_of: Callable[[int], CameraIdentity] = lambda _: IDENTITY,
    room: Room = ROOM,
    seed: int = 1000,
) -> list[SurveyPhoto]:
    """A photograph from each place, named by number, with noise of its own."""
    return [
        SurveyPhoto(
            f"photo{index}.jpg",
            identity_of(index),
            photograph(room, place, np.random.default_rng(seed + index), camera_of(index)),
        )
        for index, place in enumerate(places)
    ]


def zoomed(factor: float, camera: Camera = CAMERA) -> Camera:
    """The camera with another focal length."""
    intrinsics = camera.intrinsics.copy()
    intrinsics[:2] *= factor
    return camera.with_intrinsics(intrinsics)
