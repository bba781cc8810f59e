"""Errors that a plate's dots share, beside what their covariances say: ``python -m benchmarks.plate_errors ROOM``.

The errors of all dots in a room with truth, in units of their covariances, parted as ``PlateSigmas`` does: a plate's
shift, its linear deformation, and the rest; by size and by incidence.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.cli.room import TrueShots, open_room, true_shots
from app.geometry.plate_sigmas import LINEAR, SHIFT, PlateSigmas
from app.photogrammetry.plate_correlation import plate_basis
from app.photogrammetry.sightings import whitening_of
from app.photogrammetry.survey import SurveyPhoto
from benchmarks.detecting import Reading, read_room

Array = npt.NDArray[np.float64]

SIZES_PX_PER_U = (0.0, 2.5, 3.5, 5.0, 8.0, np.inf)
INCIDENCES_DEG = (0.0, 20.0, 40.0, 60.0, 90.0)
FAR_OFF_PX = 3.0  # a centre further off than this is another dot's


def main() -> int:
    """Detect, part the errors, print."""
    parser = argparse.ArgumentParser(prog="plate_errors", description=__doc__)
    parser.add_argument("room", type=Path)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    room = open_room(arguments.room)
    read = read_room(room, Reading("default", "golay", arguments.workers), lambda _stage, _done, _total: None)
    survey, snapshots = (true_shots(room.folder / part) for part in ("survey", "locate"))
    rows = np.array([*_rows(read.survey, survey), *_rows(read.snapshots, snapshots)])
    print("plates                       count   shift  linear    dots")
    _print("all", rows)
    for low, high in pairwise(SIZES_PX_PER_U):
        _print(f"{low:g} to {high:g} px per u", rows[(rows[:, 0] >= low) & (rows[:, 0] < high)])
    for low, high in pairwise(INCIDENCES_DEG):
        _print(f"{low:g} to {high:g} degrees", rows[(rows[:, 1] >= low) & (rows[:, 1] < high)])
    return 0


def _rows(photos: tuple[SurveyPhoto, ...], truth: TrueShots) -> Iterator[Array]:
    """Size, incidence, sums of squares of shift, linear part and rest, and the rest's number, of each plate."""
    for photo in photos:
        plates = {plate.code: plate for plate in truth.shots[photo.name].plates}
        for seen in photo.detection.targets:
            plate = plates.get(seen.code)
            if plate is None or np.abs((seen.centres_px - plate.dots_px)[seen.measured]).max() > FAR_OFF_PX:
                continue
            whitening = whitening_of(seen)
            whitened = (whitening @ (seen.centres_px - plate.dots_px)[..., None]).ravel()
            modes = plate_basis(whitening[None])[0].T @ whitened
            squares = (modes[SHIFT] @ modes[SHIFT], modes[LINEAR] @ modes[LINEAR], whitened @ whitened - modes @ modes)
            rest = 2 * np.count_nonzero(seen.measured) - len(modes)
            yield np.array([plate.px_per_u, plate.incidence_deg, *squares, rest])


def _print(name: str, rows: Array) -> None:
    if not len(rows):
        return
    squares, numbers = rows[:, 2:5].sum(axis=0), np.array([2 * len(rows), 4 * len(rows), rows[:, 5].sum()])
    sigmas = PlateSigmas(*np.sqrt(squares / numbers).tolist())
    print(f"{name:25s} {len(rows):8d} {sigmas.shift:7.2f} {sigmas.linear:7.2f} {sigmas.dots:7.2f}")


if __name__ == "__main__":
    sys.exit(main())
