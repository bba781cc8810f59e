"""Random triples of red dots, and how many are taken for plates with a side hidden: ``python -m benchmarks.triples``.

Two stages, as ``benchmarks.quintuples`` has them:

1. three dots at random places: the share that lies and looks like E and two corners of a side;
2. three dots forced to lie so (a plate seen at random, each dot off its place by a little, of random size), on textured
   or dark ground, alone or among coloured dots at random places, with a board of random colour over the side that would
   be hidden: the share that is accepted.

A random triple is accepted with less than the product of both: hardly any has a board in the right place.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from app.cli.arguments import at_least_one
from app.cli.progress import progress
from app.targets.family import family_by_name
from app.targets.layout import BASE_CELLS, DIGIT_CELLS
from app.vision.detector import detect
from app.vision.dots import find_red_blobs
from app.vision.hidden_sides import SEEN_CORNERS, complete_sides
from benchmarks.false_targets import site_codes
from benchmarks.hostile_pictures import FAMILY, HEIGHT_PX, INKS, WIDTH_PX, Pixels, as_taken, disc, texture
from benchmarks.output import print_table, write_json
from benchmarks.quintuples import (
    CELL_PX,
    GROUNDS,
    NONE,
    PX_PER_U,
    RED_RGB,
    Forced,
    line_of,
    measure,
    seen_places_px,
    share_of_random,
)

Floats = npt.NDArray[np.float64]

E_CELL = BASE_CELLS[4]
SAME_PLACE_PX = 2.0
BOARD_REACH_U = (1.0, 2.0)  # beyond the hidden dots' centres, inwards and outwards, at least
BOARD_HALF_U = 7.0  # along the side


def main() -> int:
    """Count, print, write."""
    arguments = _arguments()
    with progress() as report:
        share = share_offered(arguments.random, seed=1)
        totals = measure(count_forced, arguments.pictures, arguments.workers, report)
    print_table(
        f"Random triples: {share:.2e} of {arguments.random} look like E and two corners. Forced so, at normal:",
        ["ground", "drawn", "offered", "accepted", "on the list", "listed, random, at most"],
        [line_of(ground, total, share) for ground, total in [*totals.items(), ("all", sum(totals.values(), NONE))]],
    )
    write_json(arguments.out / "triples.json", {"share_offered": share, "forced": totals})
    return 0


def share_offered(count: int, seed: int) -> float:
    """Part of triples of like dots at random places near each other that may be E and two corners."""
    return share_of_random(lambda blobs: len(complete_sides(blobs, np.arange(3))[1]) > 0, 3, count, seed)


def count_forced(task: tuple[str, int]) -> Forced:
    """The triples of one picture."""
    bgr, places_px = forced_picture(*task)
    blobs = find_red_blobs(bgr)
    extended, groups = complete_sides(blobs, np.arange(len(blobs)))
    offered = np.sort(np.where(groups < len(blobs), groups, len(extended)), axis=1)[:, :3]
    centres_px = extended.centres_px[offered]  # (G, 3, 2)
    away_px = np.linalg.norm(centres_px[:, :, None, None] - places_px, axis=4)  # (G, 3, N, 3)
    grouped = (away_px.min(axis=1) < SAME_PLACE_PX).all(axis=2).any(axis=0).sum()
    codes = {target.code for target in detect(bgr, family_by_name(FAMILY), known_codes=site_codes()).targets}
    return Forced(len(places_px), int(grouped), len(codes), len(codes & site_codes()))


def forced_picture(ground: str, seed: int) -> tuple[Pixels, Floats]:
    """A picture full of triples, and where they are, shape (N, 3, 2), px."""
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
            side = int(rng.integers(len(SEEN_CORNERS)))
            seen = [E_CELL, *(BASE_CELLS[corner] for corner in SEEN_CORNERS[side])]
            _board(picture, dots_px, side, rng)
            for cell in seen:
                disc(picture, dots_px[cell], radius_px, RED_RGB)
            places.append(dots_px[seen])
    return as_taken(picture, rng), np.array(places)


def _board(picture: Pixels, dots_px: Floats, side: int, rng: np.random.Generator) -> None:
    """A board of any colour over the two corners that are not of this side, and what lies between them."""
    a, b, c, d = (dots_px[BASE_CELLS[(side + corner) % 4]] for corner in range(4))  # a and b are seen
    along, inwards = (c - d) / 9.0, (b - c + a - d) / 18.0  # px per u
    near, far = BOARD_REACH_U
    middle = 0.5 * (c + d)
    corners = [
        middle + sideways * BOARD_HALF_U * along + depth * inwards
        for sideways, depth in ((-1, near), (1, near), (1, -far), (-1, -far))
    ]
    colour = tuple(int(value) for value in rng.integers(0, 256, 3))
    cv2.fillConvexPoly(picture, np.rint(corners).astype(np.int32), colour, cv2.LINE_AA)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="triples", description=__doc__)
    parser.add_argument("--random", type=at_least_one, default=1_000_000, help="triples at random places")
    parser.add_argument("--pictures", type=at_least_one, default=1_000, help="of each ground, 108 triples each")
    parser.add_argument("--workers", type=at_least_one, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("benchmarks/out"))
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
