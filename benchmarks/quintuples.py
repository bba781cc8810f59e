"""Random quintuples of red dots, and how many are taken for targets: ``python -m benchmarks.quintuples``.

Two stages, because chance alone hardly ever puts five dots in the shape of a plate:

1. five dots at random places: the share that the grouping lets through, from geometry alone;
2. five dots forced into that shape (a plate's base dots seen at random, each off its place by a little, of random
   size, on textured or dark ground, alone or among coloured dots at random places): the share that is accepted.

A random quintuple is accepted with the product of both. The bound on it is Poisson's, one-sided, with a confidence of
95 %: where none of n is accepted, 3 / n (the rule of three); where one is, 4.7 / n. A forced quintuple counts only if
the detector's own grouping offers it.
Dots in all sixteen places of a plate are no random quintuple: ``benchmarks.false_targets`` counts such look-alikes.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.stats import chi2

from app.cli.arguments import at_least_one
from app.cli.in_parallel import in_parallel
from app.cli.progress import Report, progress
from app.geometry.rotation import exp_rotation
from app.targets.family import family_by_name
from app.targets.layout import BASE_CELLS, DIGIT_CELLS
from app.vision.detector import DetectorOptions, detect
from app.vision.dots import Blobs, find_red_blobs
from app.vision.grouping import group_base_dots
from app.vision.homography import PLATE_DOTS_U
from benchmarks.false_targets import site_codes
from benchmarks.hostile_pictures import FAMILY, HEIGHT_PX, INKS, WIDTH_PX, Pixels, as_taken, disc, texture
from benchmarks.output import print_table, write_json

RED_RGB = INKS[0]
CELL_PX = 80  # a quintuple in each
OFF_U = 0.15  # of each dot from its place: more, and the grouping lets too few through
PX_PER_U = (2.5, 4.5)
SLANT_RAD = 1.0
DISTANCE_U = 60.0
AREA_RADII = 9.0  # a plate's dots spread over so many radii
LEAST_GAP_RADII = 2.0  # dots do not overlap
CONFIDENCE = 0.95
GROUNDS = ("texture", "dark texture", "dark, among coloured dots")
FOCAL_PX = DetectorOptions().least_focal_share * WIDTH_PX


@dataclass(frozen=True)
class Forced:
    """What became of the forced quintuples of some pictures.

    Attributes
    ----------
    drawn, grouped : int
        Quintuples, and those that the detector's grouping offers as five base dots.
    accepted, listed : int
        Targets accepted, and those of them that a site's list holds.
    """

    drawn: int
    grouped: int
    accepted: int
    listed: int

    def __add__(self, other: Forced) -> Forced:
        """Both together."""
        return Forced(
            self.drawn + other.drawn,
            self.grouped + other.grouped,
            self.accepted + other.accepted,
            self.listed + other.listed,
        )


NONE = Forced(0, 0, 0, 0)


def main() -> int:
    """Count, print, write."""
    arguments = _arguments()
    with progress() as report:
        share = share_grouped(arguments.random, seed=1)
        totals = measure(count_forced, arguments.pictures, arguments.workers, report)
    print_table(
        f"Random quintuples: {share:.2e} of {arguments.random} look like base dots. Forced into that shape, at normal:",
        ["ground", "drawn", "grouped", "accepted", "on the list", "listed, random, at most"],
        [line_of(ground, total, share) for ground, total in [*totals.items(), ("all", sum(totals.values(), NONE))]],
    )
    write_json(arguments.out / "quintuples.json", {"share_grouped": share, "forced": totals})
    return 0


def share_grouped(count: int, seed: int) -> float:
    """Part of quintuples of like dots at random places near each other that the grouping takes for base dots."""
    return share_of_random(lambda blobs: len(group_base_dots(blobs, FOCAL_PX)) > 0, 5, count, seed)


def share_of_random(offers: Callable[[Blobs], bool], dots: int, count: int, seed: int) -> float:
    """Part of ``count`` sets of so many like dots, at random places near each other, that are offered as a plate's."""
    rng = np.random.default_rng(seed)
    radius_px, offered, tried = 4.0, 0, 0
    while tried < count:
        centres_px = rng.uniform(0.0, AREA_RADII * radius_px * 1.4, (dots, 2))
        apart = np.linalg.norm(centres_px[:, None] - centres_px, axis=2) + 1e9 * np.eye(dots)
        if apart.min() < LEAST_GAP_RADII * radius_px:
            continue
        tried += 1
        offered += offers(Blobs(centres_px, np.full((dots, 2), radius_px)))
    return offered / count


def measure(
    count: Callable[[tuple[str, int]], Forced], pictures: int, workers: int, report: Report
) -> dict[str, Forced]:
    """What ``count`` finds among the forced dots of pictures, by ground, over so many pictures of each."""
    tasks = [(ground, seed) for ground in GROUNDS for seed in range(pictures)]
    results = in_parallel(count, tasks, (), workers, report)
    totals = dict.fromkeys(GROUNDS, NONE)
    for (ground, _), result in zip(tasks, results, strict=True):
        totals[ground] = totals[ground] + result
    return totals


def count_forced(task: tuple[str, int]) -> Forced:
    """The quintuples of one picture."""
    bgr, places_px = forced_picture(*task)
    blobs = find_red_blobs(bgr)
    offered = blobs.centres_px[group_base_dots(blobs, FOCAL_PX)]  # (G, 5, 2)
    grouped = sum(bool((np.linalg.norm(offered - place, axis=2) < 2.0).all(axis=1).any()) for place in places_px)
    codes = {target.code for target in detect(bgr, family_by_name(FAMILY), known_codes=site_codes()).targets}
    return Forced(len(places_px), grouped, len(codes), len(codes & site_codes()))


def forced_picture(ground: str, seed: int) -> tuple[Pixels, npt.NDArray[np.float64]]:
    """A picture full of quintuples in the shape of base dots, and where they are, shape (N, 5, 2), px."""
    rng = np.random.default_rng([GROUNDS.index(ground), seed])
    picture = texture(rng, darkness=1.0 if ground == "texture" else 0.15)
    places = []
    for x in range(CELL_PX // 2, WIDTH_PX, CELL_PX):
        for y in range(CELL_PX // 2, HEIGHT_PX, CELL_PX):
            px_per_u = rng.uniform(*PX_PER_U)
            dots_px = seen_places_px(rng, px_per_u) + np.array([x, y])
            radius_px = px_per_u * rng.uniform(0.7, 1.2)
            for _ in range(len(DIGIT_CELLS) if ground == GROUNDS[2] else 0):
                ink = INKS[1 + int(rng.integers(len(INKS) - 1))]
                disc(picture, rng.uniform(-6.0, 6.0, 2) * px_per_u + [x, y], radius_px, ink)
            for cell in BASE_CELLS:
                disc(picture, dots_px[cell], radius_px, RED_RGB)
            places.append(dots_px[list(BASE_CELLS)])
    return as_taken(picture, rng), np.array(places)


def seen_places_px(rng: np.random.Generator, px_per_u: float) -> npt.NDArray[np.float64]:
    """A plate's sixteen places about the origin, seen at random and each a little off, px."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    slant = exp_rotation(rng.uniform(0.0, SLANT_RAD) * np.array([np.cos(angle), np.sin(angle), 0.0]))
    turn = slant @ exp_rotation(np.array([0.0, 0.0, rng.uniform(0.0, 2.0 * np.pi)]))
    off_u = PLATE_DOTS_U + rng.normal(0.0, OFF_U, PLATE_DOTS_U.shape)
    x, y, depth = turn @ np.column_stack([off_u, np.zeros(len(off_u))]).T
    return np.asarray(px_per_u * np.column_stack([x, y]) / (1.0 + depth / DISTANCE_U)[:, None])


def at_most_by_chance(total: Forced, share: float) -> float:
    """Upper bound on the part of random ones that is accepted with a listed code."""
    at_most = float(chi2.ppf(CONFIDENCE, 2 * (total.listed + 1))) / 2.0  # of a Poisson count (Garwood, 1936)
    return share * at_most / max(total.grouped, 1)


def line_of(ground: str, total: Forced, share: float) -> list[str]:
    """A ground's counts, and what they say of random ones."""
    counts = (total.drawn, total.grouped, total.accepted, total.listed)
    return [ground, *(str(count) for count in counts), f"{at_most_by_chance(total, share):.1e}"]


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="quintuples", description=__doc__)
    parser.add_argument("--random", type=at_least_one, default=1_000_000, help="quintuples at random places")
    parser.add_argument("--pictures", type=at_least_one, default=1_000, help="of each ground, 108 quintuples each")
    parser.add_argument("--workers", type=at_least_one, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("benchmarks/out"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
