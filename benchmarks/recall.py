"""Recall where it is hard: ``python -m benchmarks.recall``.

A matrix of conditions and severities over rendered photographs: of the plates in view, how many the default detector
and the published method read, and how many codes they make up. ``--rows light`` takes the rows whose names hold that
word; ``--look DIR`` keeps one picture of each cell.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from app.cli.arguments import at_least_one
from app.cli.in_parallel import in_parallel
from app.cli.progress import Report, progress
from app.geometry.observations import Detection, TargetObservation
from app.targets.family import family_by_name
from app.targets.layout import BASE_CELLS
from app.vision.detectors import DETECTOR_NAMES, DetectorName, choose_detector
from benchmarks.detection_score import SAME_PLACE_U
from benchmarks.output import print_table, write_json
from benchmarks.recall_conditions import Row, matrix
from benchmarks.recall_views import Condition, HardPhoto, hard_photo

PERCENT = 100.0
WHAT = ("read", "wrong")  # both in per cent
SEEDS_PER_CELL = 1_000  # photographs of different cells never share a seed
DIAGONAL_U = 9.0 * 2.0**0.5  # from A to C
A, C = BASE_CELLS[0], BASE_CELLS[2]


@dataclass(frozen=True)
class Count:
    """What one detector made of the plates of some photographs.

    Attributes
    ----------
    found, wrong : int
        Plates read rightly, and targets that hang nowhere.
    """

    found: int
    wrong: int


@dataclass(frozen=True)
class Task:
    """One photograph of one cell."""

    row: str
    severity: str
    condition: Condition
    seed: int


@dataclass(frozen=True)
class Cell:
    """The figures of a cell: its plates, and what each detector read."""

    row: str
    severity: str
    plates: int
    counts: dict[DetectorName, Count]


def main() -> int:
    """Measure, print, write."""
    arguments = _arguments()
    rows = {name: row for name, row in matrix().items() if arguments.rows in name}
    if not rows:
        print(f"recall: no row's name holds {arguments.rows!r}", file=sys.stderr)
        return 1
    with progress() as report:
        cells = measure(rows, arguments.photos, arguments.seed, arguments.workers, report)
    if arguments.look is not None:
        keep_pictures(rows, arguments.seed, arguments.look)
    print_cells(cells)
    write_json(arguments.out / "recall.json", {"seed": arguments.seed, "cells": cells})
    return 0


def measure(rows: Mapping[str, Row], photos: int, seed: int, workers: int, report: Report) -> list[Cell]:
    """All cells of some rows, each over so many photographs."""
    tasks = [task for row in rows for task in tasks_of(row, rows[row], photos, seed)]
    results = in_parallel(read_photo, tasks, (), workers, report)
    cells: dict[tuple[str, str], Cell] = {}
    for task, (plates, counts) in zip(tasks, results, strict=True):
        before = cells.get((task.row, task.severity))
        cells[task.row, task.severity] = _added(before, Cell(task.row, task.severity, plates, counts))
    return list(cells.values())


def tasks_of(name: str, row: Row, photos: int, seed: int) -> list[Task]:
    """The photographs of a row. All its cells show the same plates where their conditions leave room for them."""
    seeds = [seed * SEEDS_PER_CELL + index for index in range(photos)]
    return [Task(name, severity, condition, one) for severity, condition in row.items() for one in seeds]


def read_photo(task: Task) -> tuple[int, dict[DetectorName, Count]]:
    """The number of plates in a photograph, and what each detector makes of them."""
    family = family_by_name(task.condition.family)
    photo = hard_photo(task.condition, family.codes, task.seed)
    counts = {name: score(choose_detector(name).detect(photo.bgr, family), photo) for name in DETECTOR_NAMES}
    return len(photo.plates), counts


def score(detection: Detection, photo: HardPhoto) -> Count:
    """Targets that stand where their code's plate is, and all others."""
    middles_px = {plate.code: plate.dots_px.mean(axis=0) for plate in photo.plates}
    right = [target for target in detection.targets if _is_there(target, middles_px.get(target.code))]
    return Count(len(right), len(detection.targets) - len(right))


def _is_there(target: TargetObservation, middle_px: np.ndarray | None) -> bool:
    u_px = float(np.linalg.norm(target.centres_px[A] - target.centres_px[C])) / DIAGONAL_U
    return middle_px is not None and bool(np.linalg.norm(target.centre_px - middle_px) < SAME_PLACE_U * u_px)


def _added(before: Cell | None, cell: Cell) -> Cell:
    if before is None:
        return cell
    counts = {
        name: Count(count.found + before.counts[name].found, count.wrong + before.counts[name].wrong)
        for name, count in cell.counts.items()
    }
    return Cell(cell.row, cell.severity, before.plates + cell.plates, counts)


def print_cells(cells: Sequence[Cell]) -> None:
    """One line per cell, the detectors side by side."""
    headings = ["condition", "severity", "plates", *(f"{name}: {what}" for name in DETECTOR_NAMES for what in WHAT)]
    rows = []
    for cell in cells:
        shares = [
            f"{PERCENT * number / cell.plates:.1f}"
            for count in cell.counts.values()
            for number in (count.found, count.wrong)
        ]
        rows.append([cell.row, cell.severity, str(cell.plates), *shares])
    print_table("Recall where it is hard: plates read rightly, and wrong codes, in % of the plates", headings, rows)


def keep_pictures(rows: Mapping[str, Row], seed: int, folder: Path) -> None:
    """The first photograph of each cell as PNG."""
    folder.mkdir(parents=True, exist_ok=True)
    for task in (task for name, row in rows.items() for task in tasks_of(name, row, 1, seed)):
        name = "".join(letter if letter.isalnum() else "-" for letter in f"{task.row} {task.severity}")
        photo = hard_photo(task.condition, family_by_name(task.condition.family).codes, task.seed)
        cv2.imwrite(str(folder / f"{name}.png"), photo.bgr)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="recall", description=__doc__)
    parser.add_argument("--rows", default="", metavar="WORD", help="rows whose names hold it (all)")
    parser.add_argument("--photos", type=at_least_one, default=5, help="photographs of each cell")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--look", type=Path, metavar="DIR", help="keep one picture of each cell")
    parser.add_argument("--workers", type=at_least_one, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("benchmarks/out"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
