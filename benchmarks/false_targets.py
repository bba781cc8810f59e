"""False targets at each level of strictness: ``python -m benchmarks.false_targets``.

Counts what is accepted in pictures that hold no target: drawn ones that try to look as if they did, and, with
``--natural DIR``, photographs. Beside that stands what each level reads of plates that are hard to read, so that both
sides of the trade are seen. With a site's list of codes only targets of that list count: a map knows no others.
"""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import cv2
import numpy as np

from app.cli.arguments import at_least_one, photo_files
from app.cli.in_parallel import in_parallel
from app.cli.progress import Report, progress
from app.cli.read_photo import read_photo
from app.errors import ScattermarkError, UnsupportedPhoto
from app.geometry.observations import Detection
from app.planning.imaging import ImagingOptions
from app.targets.family import family_by_name
from app.vision.detector import DetectorOptions, detect
from app.vision.reading import Strictness
from benchmarks.hostile_pictures import FAMILY, FOREIGN, KINDS, Pixels, hostile_picture
from benchmarks.output import print_table, write_json
from benchmarks.recall_views import Condition, hard_photo

LEVELS: tuple[Strictness, ...] = get_args(Strictness)
LIST_SEED, LISTED_CODES = 7, 100  # a site with a hundred targets
SEEDS_PER_KIND = 1_000
HARD = {
    "dim, ISO 6400, -1.5 EV": Condition(
        imaging=ImagingOptions(exposure_ev=-1.5, full_well_electrons=78.0, read_noise_electrons=4.0)
    ),
    "a tenth of a side hidden": Condition(hidden_share=0.1),
    "2 px per u, JPEG 50": Condition(px_per_u=2.0, imaging=ImagingOptions(jpeg_quality=50)),
    "shadow's edge, a quarter of the light": Condition(shadow_share=0.25),
}
PERCENT = 100.0


@dataclass(frozen=True)
class Level:
    """How detection is told to read.

    Attributes
    ----------
    strictness : str
    listed : bool
        Whether it is given a site's list of codes.
    """

    strictness: Strictness
    listed: bool

    def __str__(self) -> str:
        """As a table's heading."""
        return f"{self.strictness}, {'list' if self.listed else 'no list'}"


ALL_LEVELS = tuple(Level(strictness, listed) for listed in (False, True) for strictness in LEVELS)


def main() -> int:
    """Count, print, write."""
    arguments = _arguments()
    try:
        with progress() as report:
            record = measure(arguments.pictures, arguments.natural, arguments.workers, report)
    except ScattermarkError as error:
        print(f"false_targets: {error.detail}", file=sys.stderr)
        return 1
    levels = [str(level) for level in ALL_LEVELS]
    print_table("Targets accepted where there are none", ["picture", "number", *levels], record["false"])
    print_table(
        "Hard plates that are read, %, with wrong codes behind", ["condition", "plates", *levels], record["read"]
    )
    write_json(arguments.out / "false-targets.json", record)
    return 0


def measure(pictures: int, natural: Path | None, workers: int, report: Report) -> dict[str, Any]:
    """Rows of both tables."""
    kinds = [*KINDS, FOREIGN]
    tasks = [(kind, index) for kind in kinds for index in range(pictures)]
    counts = in_parallel(count_drawn, tasks, (), workers, report)
    rows = [_row(kind, [count for task, count in zip(tasks, counts, strict=True) if task[0] == kind]) for kind in kinds]
    if natural is not None:
        taken = in_parallel(count_taken, photo_files([natural]), (), workers, report)
        rows.append(_row("photographs", [count for count in taken if count is not None]))
    return {"false": rows, "read": [_hard_row(name, pictures, workers, report) for name in HARD]}


def count_drawn(task: tuple[str, int]) -> list[int]:
    """Targets in a drawn picture, level by level."""
    kind, index = task
    return count_in(hostile_picture(kind, [*KINDS, FOREIGN].index(kind) * SEEDS_PER_KIND + index))


def count_taken(path: Path) -> list[int] | None:
    """Targets in a photograph, level by level; None for one that is not measured, as a grey one."""
    try:
        return count_in(read_photo(path).bgr)
    except UnsupportedPhoto:
        return None


def count_in(bgr: Pixels) -> list[int]:
    """Targets accepted, level by level; with a list those on it."""
    return [len(accepted(bgr, level)) for level in ALL_LEVELS]


def accepted(bgr: Pixels, level: Level) -> set[int]:
    """Codes that a level accepts in a picture."""
    codes = {target.code for target in read(bgr, level, site_codes()).targets}
    return codes & site_codes() if level.listed else codes


def read(bgr: Pixels, level: Level, codes: frozenset[int]) -> Detection:
    """A detection at a level; ``codes`` are the site's."""
    options = DetectorOptions(strictness=level.strictness)
    return detect(bgr, family_by_name(FAMILY), options, codes if level.listed else None)


def site_codes() -> frozenset[int]:
    """A site's codes, picked at random."""
    codes = family_by_name(FAMILY).codes
    return frozenset(np.random.default_rng(LIST_SEED).choice(codes, LISTED_CODES, replace=False).tolist())


def read_hard(task: tuple[str, int]) -> tuple[int, list[tuple[int, int]]]:
    """Plates of a hard photograph, all of the site's list, and how many each level reads rightly and wrongly."""
    name, seed = task
    photo = hard_photo(HARD[name], np.array(sorted(site_codes())), seed)
    true = {plate.code for plate in photo.plates}
    found = [{target.code for target in read(photo.bgr, level, site_codes()).targets} for level in ALL_LEVELS]
    return len(true), [(len(codes & true), len(codes - true)) for codes in found]


def _hard_row(name: str, photos: int, workers: int, report: Report) -> list[str]:
    results = in_parallel(read_hard, [(name, seed) for seed in range(photos)], (), workers, report)
    plates, counts = sum(plates for plates, _ in results), np.array([counts for _, counts in results]).sum(axis=0)
    return [name, str(plates), *(f"{PERCENT * right / plates:.1f} / {wrong}" for right, wrong in counts)]


def _row(name: str, counts: list[list[int]]) -> list[str]:
    return [name, str(len(counts)), *(str(total) for total in np.array(counts).sum(axis=0))]


def keep_pictures(folder: Path) -> None:
    """One picture of each kind as PNG."""
    folder.mkdir(parents=True, exist_ok=True)
    for index, kind in enumerate([*KINDS, FOREIGN]):
        name = "".join(letter if letter.isalnum() else "-" for letter in kind)
        cv2.imwrite(str(folder / f"{name}.png"), hostile_picture(kind, index * SEEDS_PER_KIND))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="false_targets", description=__doc__)
    parser.add_argument("--natural", type=Path, metavar="DIR", help="photographs without any target")
    parser.add_argument("--pictures", type=at_least_one, default=20, help="of each kind")
    parser.add_argument("--workers", type=at_least_one, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("benchmarks/out"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
