"""A plan as photographs: the room that it describes, each shot with its setting, and the surveyor's points."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from graphlib import CycleError
from pathlib import Path

import numpy as np

from app.errors import InvalidInput
from app.geometry.camera import Camera
from app.geometry.control import ControlPoint
from app.planning.depth_order import panels_in_view
from app.planning.imaging import ImagingOptions
from app.planning.plan_control import read_control
from app.planning.plan_file import MM_PER_M, Plan, read_plan
from app.planning.plan_imaging import Habits, read_imaging
from app.planning.plan_path import Stop, read_path
from app.planning.plan_scene import scene_of
from app.planning.rays import RayGrid
from app.planning.scene import Scene
from app.planning.sight import see
from app.planning.smear import motion_px
from app.planning.synthetic import RenderedPhoto, render
from app.planning.walk import Walk

EXIF_TIME = "%Y:%m:%d %H:%M:%S.%f"
EXIF_TIME_LENGTH = len("2026:01:01 12:00:00.000")  # milliseconds
GREATEST_SEED = 2**31 - 1
SURVEY, SNAPSHOTS = 1, 2  # roles: photographs of the same number draw their noise apart


@dataclass(frozen=True)
class Shot:
    """A photograph to be taken: where, when, how, and with which noise.

    Attributes
    ----------
    stop : Stop
    imaging : ImagingOptions
    seed : int
    """

    stop: Stop
    imaging: ImagingOptions
    seed: int


@dataclass(frozen=True)
class Simulation:
    """A plan, ready to be photographed.

    Attributes
    ----------
    plan : Plan
    scene : Scene
    survey, snapshots : tuple of Shot
    control : tuple of ControlPoint
        As a surveyor would hand them in, with noise.
    seed : int
    """

    plan: Plan
    scene: Scene
    survey: tuple[Shot, ...]
    snapshots: tuple[Shot, ...]
    control: tuple[ControlPoint, ...]
    seed: int

    @property
    def camera(self) -> Camera:
        """The true intrinsics."""
        return self.plan.camera.camera

    @property
    def u_m(self) -> float:
        """Module of all plates."""
        return self.scene.targets[0].u_m

    def photograph(self, shot: Shot) -> RenderedPhoto:
        """Take one of the shots; the same plan and seed give the same bytes."""
        return render(self.scene, self.camera, shot.stop.site_from_cam, shot.imaging, shot.seed)


def read_simulation(path: Path, seed: int | None = None) -> Simulation:
    """Read a plan file with a ``path``, and check that all of it can be photographed.

    Parameters
    ----------
    path : Path
        YAML or JSON; ``docs/simulation.md`` describes it.
    seed : int, optional
        Instead of the plan's own.

    Raises
    ------
    InvalidInput
        Naming line and field, and what is needed.
    """
    plan = read_plan(path)
    if "path" not in plan.sections:
        raise InvalidInput(f"{path.name}: path is missing: it says where photographs are taken from", field="path")
    if seed is None:
        seed = plan.sections["seed"].integer(0, GREATEST_SEED) if "seed" in plan.sections else 1
    _check_targets(plan, path.name)
    stops = read_path(plan.sections["path"], seed)
    habits = read_imaging(plan.sections["imaging"]) if "imaging" in plan.sections else Habits()
    scene, camera = scene_of(plan, seed), plan.camera.camera
    _check_order(scene, camera, (*stops.survey, *stops.snapshots), path.name)
    seen = [see(scene, camera, stop.site_from_cam) for stop in stops.survey]
    control = read_control(plan, seen, seed)
    photographer = _Photographer(scene, camera, stops.walk, habits, seed)
    survey, snapshots = photographer.shots(stops.survey, SURVEY), photographer.shots(stops.snapshots, SNAPSHOTS)
    return Simulation(plan, scene, survey, snapshots, control, seed)


@dataclass(frozen=True)
class _Photographer:
    """Draws the setting of each photograph."""

    scene: Scene
    camera: Camera
    walk: Walk | None
    habits: Habits
    seed: int

    def shots(self, stops: tuple[Stop, ...], role: int) -> tuple[Shot, ...]:
        """Each stop with its setting; each has a stream of random numbers of its own."""
        return tuple(
            self._shot(stop, np.random.default_rng([self.seed, role, index])) for index, stop in enumerate(stops)
        )

    def _shot(self, stop: Stop, rng: np.random.Generator) -> Shot:
        captured_at = datetime.fromtimestamp(stop.time_s, UTC).strftime(EXIF_TIME)[:EXIF_TIME_LENGTH]
        imaging = self.habits.one(self._motion_px(stop), captured_at, rng)
        return Shot(stop, imaging, int(rng.integers(GREATEST_SEED)))

    def _motion_px(self, stop: Stop) -> tuple[float, float]:
        if self.walk is None or stop.walk_s is None:
            return 0.0, 0.0
        half_s = self.habits.exposure_s / 2
        begin, end = (self.walk.pose_at(stop.walk_s + offset_s) for offset_s in (-half_s, half_s))
        return motion_px(self.scene, self.camera, (begin, stop.site_from_cam, end))


def _check_targets(plan: Plan, source: str) -> None:
    """A survey measures plates of one size."""
    sizes_mm = sorted({round(MM_PER_M * target.u_m, 6) for target in plan.targets})
    if not sizes_mm:
        raise InvalidInput(f"{source}: there are no targets: list them under targets, or say post: {{count: 20}}")
    if len(sizes_mm) > 1:
        listed = ", ".join(f"{size:g}" for size in sizes_mm)
        raise InvalidInput(
            f"{source}: plates of u = {listed} mm; a survey measures plates of one size: give all one u_mm"
        )


def _check_order(scene: Scene, camera: Camera, stops: tuple[Stop, ...], source: str) -> None:
    """Nothing is rendered before it is known that all of it can be drawn."""
    rays, panels = RayGrid(camera), scene.all_panels()
    for stop in stops:
        try:
            panels_in_view(panels, rays, stop.site_from_cam)
        except CycleError as error:
            x_m, y_m, z_m = stop.site_from_cam.position_m
            raise InvalidInput(
                f"{source}: seen from ({x_m:.2f}, {y_m:.2f}, {z_m:.2f}) m, walls or targets hide each other in a ring; "
                f"cut the wall that passes through another in two"
            ) from error
