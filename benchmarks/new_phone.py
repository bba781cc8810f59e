"""Photographs of the demonstration room by a phone that its survey never saw, rendered from the room's truth.

python -m benchmarks.new_phone OUT        OUT/calibrate/*.jpg, OUT/locate/*.jpg and OUT/locate/truth.json
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from app.cli.room import open_room, true_dots_m
from app.geometry.camera import Camera
from app.geometry.pose import Pose
from app.geometry.similarity import estimate_similarity
from app.planning.imaging import ImagingOptions
from app.planning.posting import RoomOptions
from app.planning.room import build_room
from app.planning.scene import PostedTarget, Scene
from app.planning.survey_plan import StationOptions, plan_stations
from app.planning.synthetic import RenderedPhoto, render
from app.targets.family import family_by_name
from app.targets.layout import dots_target_m

ROOM = Path("examples/room")
ROOM_SIZE_M = (5.0, 4.0, 2.6)  # examples/room/README.md
SEEDS_PER_ROLE = 1000


@dataclass(frozen=True)
class Phone:
    """A camera and what its files say of it."""

    camera: Camera
    imaging: ImagingOptions


def new_phone(width_px: int = 1600, height_px: int = 1200) -> Phone:
    """A wider lens than that of the room's survey, in another frame, with its own distortion."""
    long_px = max(width_px, height_px)
    centre_px = np.array([width_px - 1, height_px - 1]) / 2.0 + np.array([-0.005, 0.004]) * long_px
    intrinsics = np.array([0.712 * long_px, 0.7125 * long_px, *centre_px, 0.11, -0.24, -4e-4, 7e-4, 0.09])
    imaging = replace(ImagingOptions(), make="Corona", model="Nine", focal_mm=4.25)
    return Phone(Camera(width_px, height_px, intrinsics), imaging)


def room_scene(folder: Path = ROOM) -> Scene:
    """The room's targets where they hang, in a room of its size."""
    room = open_room(folder)
    plain = build_room(RoomOptions(ROOM_SIZE_M, targets=0, furniture=False), family_by_name("golay"), seed=0)
    targets = tuple(_posted(code, dots_m, room.plate_u_m) for code, dots_m in true_dots_m(room).items())
    return replace(plain, targets=targets)


def photographs(phone: Phone, stations: tuple[Pose, ...], seed: int, folder: Path = ROOM) -> list[RenderedPhoto]:
    """What the phone sees from the stations."""
    scene = room_scene(folder)
    return [render(scene, phone.camera, station, phone.imaging, seed + index) for index, station in enumerate(stations)]


def stations_of(count: int, seed: int, upright_every: int = 3) -> tuple[Pose, ...]:
    """Places on an ellipse in the room, looking across it."""
    return plan_stations(ROOM_SIZE_M, StationOptions(count=count, upright_every=upright_every), seed)


def _posted(code: int, dots_m: np.ndarray, u_m: float) -> PostedTarget:
    """The plate of dots in the site frame."""
    fit = estimate_similarity(dots_target_m(u_m), dots_m)
    return PostedTarget(code, Pose(fit.rotation, fit.translation_m), u_m, (fit.scale, fit.scale))


def main() -> None:
    """Render and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--calibrate", type=int, default=12, help="photographs to calibrate from (12)")
    parser.add_argument("--locate", type=int, default=12, help="snapshots to locate (12)")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    phone = new_phone()
    for role, (name, count) in enumerate((("calibrate", arguments.calibrate), ("locate", arguments.locate))):
        seed = arguments.seed + role * SEEDS_PER_ROLE
        folder = arguments.out / name
        folder.mkdir(parents=True, exist_ok=True)
        taken = photographs(phone, stations_of(count, seed), seed)
        for index, photo in enumerate(taken):
            (folder / f"{name}{index:02d}.jpg").write_bytes(photo.jpeg)
        truth = {f"{name}{index:02d}.jpg": photo.site_from_cam.position_m.tolist() for index, photo in enumerate(taken)}
        (folder / "truth.json").write_text(
            json.dumps({"intrinsics": phone.camera.intrinsics.tolist(), "positions": truth})
        )


if __name__ == "__main__":
    main()
