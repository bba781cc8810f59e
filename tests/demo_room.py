"""The demonstration room for the renderer: its targets where the truth has them, between bare walls."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.geometry.camera import Camera
from app.geometry.pose import Pose
from app.geometry.similarity import estimate_similarity
from app.planning.imaging import ImagingOptions
from app.planning.posting import RoomOptions
from app.planning.room import build_room
from app.planning.scene import PostedTarget, Scene
from app.planning.survey_plan import look_at
from app.planning.synthetic import render
from app.targets.family import family_by_name
from app.targets.layout import dots_target_m
from tests.api.serving import ROOM

SIZE_M = (5.0, 4.0, 2.6)


def demo_scene() -> Scene:
    """The room as it was surveyed."""
    record = json.loads((ROOM / "targets_truth.json").read_text())
    walls = build_room(RoomOptions(SIZE_M, targets=0, furniture=False), family_by_name("golay"), seed=1)
    nominal_m = dots_target_m(record["u_m"])
    targets = []
    for target in record["targets"]:
        fit = estimate_similarity(nominal_m, np.array(target["dots_m"]))
        pose = Pose(fit.rotation, fit.translation_m)
        targets.append(PostedTarget(target["code"], pose, record["u_m"], (fit.scale, fit.scale)))
    return replace(walls, targets=tuple(targets))


def demo_camera() -> Camera:
    """The camera of the demonstration's snapshots."""
    camera = json.loads((ROOM / "locate" / "truth.json").read_text())["camera"]
    intrinsics = [camera["fx"], camera["fy"], camera["cx"], camera["cy"], *camera["dist"]]
    return Camera(camera["w"], camera["h"], np.array(intrinsics))


def with_moved(scene: Scene, code: int, shift_m: Sequence[float]) -> Scene:
    """The room after a target was moved."""
    moved = tuple(
        replace(
            target,
            site_from_target=Pose(target.site_from_target.rotation, target.site_from_target.position_m + shift_m),
        )
        if target.code == code
        else target
        for target in scene.targets
    )
    return replace(scene, targets=moved)


def photograph(scene: Scene, position_m: Sequence[float], aim_m: Sequence[float], seed: int) -> bytes:
    """A snapshot of the room."""
    pose = look_at(np.array(position_m, dtype=np.float64), np.array(aim_m, dtype=np.float64))
    return render(scene, demo_camera(), pose, ImagingOptions(), seed).jpeg
