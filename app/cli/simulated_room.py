"""A simulated room's folder: photographs rendered in worker processes, and the truth beside them."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.cli.in_parallel import in_parallel
from app.cli.progress import Report
from app.planning.plan_control import LEAST_RAYS, rays_of
from app.planning.sight import SeenTarget
from app.planning.simulation_plan import Shot, Simulation
from app.planning.truth import camera_record, control_csv, shot_record, targets_record, walk_truth
from app.trajectories.formats import csv_text
from app.trajectories.robotics_formats import tum_text


@dataclass(frozen=True)
class Taken:
    """A photograph that was written.

    Attributes
    ----------
    name : str
    seen : tuple of SeenTarget
        What it shows.
    cpu_s : float
        Processor time of rendering and encoding.
    """

    name: str
    seen: tuple[SeenTarget, ...]
    cpu_s: float


@dataclass(frozen=True)
class Rendered:
    """All photographs of a room."""

    survey: tuple[Taken, ...]
    snapshots: tuple[Taken, ...]

    @property
    def cpu_s(self) -> float:
        """Processor time of all."""
        return sum(taken.cpu_s for taken in (*self.survey, *self.snapshots))

    def seldom_seen(self, simulation: Simulation) -> list[int]:
        """Codes of targets that the survey will not place."""
        rays = rays_of([taken.seen for taken in self.survey])
        return [target.code for target in simulation.scene.targets if rays[target.code] < LEAST_RAYS]

    def without_target(self) -> list[str]:
        """Photographs with no target wholly in view, as ``survey/IMG_0000.jpg``."""
        folders = (("survey", self.survey), ("locate", self.snapshots))
        return [
            f"{folder}/{taken.name}"
            for folder, photos in folders
            for taken in photos
            if not any(target.whole for target in taken.seen)
        ]


def write_room(simulation: Simulation, folder: Path, workers: int, report: Report) -> Rendered:
    """Render everything into a folder that is there and empty."""
    (folder / "control_points.csv").write_text(control_csv(simulation.control))
    targets = targets_record(simulation.scene.targets, simulation.u_m)
    _write_json(folder / "targets_truth.json", {"seed": simulation.seed, **targets})
    shots = (*simulation.survey, *simulation.snapshots)
    files = [folder / "survey" / shot.stop.name for shot in simulation.survey]
    files += [folder / "locate" / shot.stop.name for shot in simulation.snapshots]
    for part in sorted({file.parent for file in files}):
        part.mkdir()

    def rendering(_: str, done: int, total: int) -> None:
        report("rendering", done, total)

    taken = in_parallel(take, list(zip(shots, files, strict=True)), (simulation,), workers, rendering)
    survey, snapshots = tuple(taken[: len(simulation.survey)]), tuple(taken[len(simulation.survey) :])
    _write_truth(folder / "survey", simulation, simulation.survey, survey)
    if snapshots:
        _write_truth(folder / "locate", simulation, simulation.snapshots, snapshots)
    return Rendered(survey, snapshots)


def take(shot_and_file: tuple[Shot, Path], simulation: Simulation) -> Taken:
    """Render one photograph and write it; runs in a worker."""
    shot, file = shot_and_file
    began_s = time.process_time()
    photo = simulation.photograph(shot)
    file.write_bytes(photo.jpeg)
    return Taken(shot.stop.name, photo.targets, time.process_time() - began_s)


def _write_truth(folder: Path, simulation: Simulation, shots: Sequence[Shot], taken: Sequence[Taken]) -> None:
    stops = [shot.stop for shot in shots]
    records = [shot_record(stop, one.seen) for stop, one in zip(stops, taken, strict=True)]
    camera = camera_record(simulation.camera, shots[0].imaging)
    _write_json(folder / "truth.json", {"camera": camera, "shots": records})
    if any(stop.walk_s is not None for stop in stops):
        walk = walk_truth(stops)
        (folder / "walk.tum").write_text("".join(tum_text([walk])))
        (folder / "walk.csv").write_text("".join(csv_text([walk])))


def _write_json(path: Path, record: dict[str, Any]) -> None:
    path.write_text(json.dumps(record) + "\n")
