"""Errors of dot centres by stratum, beside what the noise allows: ``python -m benchmarks.centres [ROOM]``.

Without a room, rooms are rendered: other cameras, plates, lights and files. By size of dot, incidence, ink and place on
the plate: RMSE per coordinate, claimed sigma, NEES (2 expected) and mean error; then how much of their
errors the dots of a plate share.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from app.cli.read_photo import read_photo
from app.cli.room import PlateInView, true_shots
from app.geometry.observations import Detection, TargetObservation
from app.planning.imaging import ImagingOptions
from app.planning.posting import RoomOptions
from app.planning.room import build_room
from app.planning.survey_plan import StationOptions, phone_camera, plan_stations
from app.planning.synthetic import render
from app.targets.digits import digits_of_code
from app.targets.family import family_by_name
from app.targets.layout import DIGIT_CELLS, DOT_COUNT, dot_centres_u
from app.vision.detector import detect
from app.vision.photo import load_photo
from benchmarks.detection_score import SAME_PLACE_U
from benchmarks.output import print_table

Array = npt.NDArray[np.float64]

FAMILY = "golay"
INKS = ("black", "green", "white", "red")
RED = INKS.index("red")
SIZE_EDGES_PX = (0.0, 3.0, 4.5, 6.0, 9.0, 12.0, 18.0, 24.0, np.inf)  # diameters
INK_EDGES_PX = (0.0, 6.0, 12.0, np.inf)
INCIDENCE_EDGES_DEG = (0.0, 30.0, 45.0, 60.0, 90.0)
PLACES = {"corner": (0, 3, 12, 15), "edge": (1, 2, 4, 7, 8, 11, 13, 14), "inner": (5, 6, 9, 10)}
FEWEST = 20  # dots that make a row
FEWEST_OF_PLATE = 9
HEADINGS = ("", "dots", "RMSE px", "robust px", "sigma px", "NEES", "mean x, y px")
ROBUST = 1.4826  # of a normal distribution's median deviation


@dataclass(frozen=True)
class Dots:
    """N measured dots: errors (N, 2) and covariances (N, 2, 2) in px, and what they are sorted by."""

    errors_px: Array
    covariances_px2: Array
    diameters_px: Array
    incidences_deg: Array
    inks: npt.NDArray[np.int64]
    cells: npt.NDArray[np.int64]
    plates: npt.NDArray[np.int64]


@dataclass(frozen=True)
class RenderedRoom:
    """A room that no constant was chosen on."""

    seed: int
    u_m: float
    size_px: tuple[int, int]
    imaging: ImagingOptions


RENDERED = {
    "good light, sharp": RenderedRoom(12, 0.014, (1920, 1080), ImagingOptions()),
    "dim, sharpened, quality 85": RenderedRoom(
        13,
        0.02,
        (1600, 1200),
        ImagingOptions(full_well_electrons=300.0, exposure_ev=-1.0, sharpening=0.4, jpeg_quality=85, lens_sigma_px=0.9),
    ),
    "defocused, bright, quality 75": RenderedRoom(
        14,
        0.02,
        (1920, 1080),
        ImagingOptions(full_well_electrons=1500.0, defocus_radius_px=1.5, exposure_ev=0.7, jpeg_quality=75),
    ),
}
TARGETS, ROOM_SIZE_M = 60, (6.0, 5.0, 2.6)


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="centres", description=__doc__)
    parser.add_argument("room", type=Path, nargs="?", help="a room with truth; without one, rooms are rendered")
    parser.add_argument("--photos", type=int, default=4, help="of each rendered room")
    arguments = parser.parse_args()
    if arguments.room is not None:
        print_strata(arguments.room.resolve().name, gather(_of_room(arguments.room)))
        return 0
    for name, room in RENDERED.items():
        print_strata(name, gather(_of_rendered(room, arguments.photos)))
    return 0


def gather(views: Iterator[tuple[Detection, Sequence[PlateInView]]]) -> Dots:
    """The measured dots of all plates that were found in their place."""
    parts: list[tuple[npt.NDArray[Any], ...]] = []
    for detection, plates in views:
        by_code = {target.code: target for target in detection.targets}
        for plate in plates:
            target = by_code.get(plate.code) if plate.code is not None else None
            if target is not None and _in_place(target, plate):
                parts.append(_dots_of(target, plate, len(parts)))
    return Dots(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def print_strata(title: str, dots: Dots) -> None:
    """Table of strata, and of shared errors."""
    print_table(title, HEADINGS, [row for name, chosen in strata(dots) if (row := _row(name, dots, chosen))])
    print_table(
        f"{title}: what the dots of a plate share, as multiples of single dots' errors",
        ("diameter px", "plates", "shift", "linear", "rest px"),
        _shared_rows(dots),
    )


def strata(dots: Dots) -> Iterator[tuple[str, npt.NDArray[np.bool_]]]:
    """Names of strata and which dots belong to each."""
    size, ink = dots.diameters_px, dots.inks
    yield "all", np.ones(len(size), dtype=np.bool_)
    yield "diameter >= 6 px", size >= 6.0
    yield "diameter >= 12 px", size >= 12.0
    for least, below in pairwise(SIZE_EDGES_PX):
        yield f"diameter {least:g}-{below:g} px", (size >= least) & (size < below)
    for least, below in pairwise(INCIDENCE_EDGES_DEG):
        yield f"incidence {least:g}-{below:g} deg", (dots.incidences_deg >= least) & (dots.incidences_deg < below)
    for index, name in enumerate(INKS):
        for least, below in pairwise(INK_EDGES_PX):
            yield f"{name}, {least:g}-{below:g} px", (ink == index) & (size >= least) & (size < below)
    for name, cells in PLACES.items():
        yield name, np.isin(dots.cells, cells)


def _row(name: str, dots: Dots, chosen: npt.NDArray[np.bool_]) -> tuple[str, ...] | None:
    if chosen.sum() < FEWEST:
        return None
    errors_px, covariances_px2 = dots.errors_px[chosen], dots.covariances_px2[chosen]
    nees = np.einsum("ni,nij,nj->n", errors_px, np.linalg.inv(covariances_px2), errors_px)
    sigma_px = np.sqrt(np.trace(covariances_px2, axis1=1, axis2=2).mean() / 2.0)
    mean_px = errors_px.mean(axis=0)
    return (
        name,
        str(int(chosen.sum())),
        f"{np.sqrt(np.square(errors_px).mean()):.4f}",
        f"{ROBUST * np.median(np.abs(errors_px)):.4f}",
        f"{sigma_px:.4f}",
        f"{nees.mean():.2f}",
        f"{mean_px[0]:+.4f}, {mean_px[1]:+.4f}",
    )


def _shared_rows(dots: Dots) -> list[tuple[str, ...]]:
    """Shift, linear deformation and rest per degree of freedom, of plates with most of their dots."""
    rows: list[tuple[str, ...]] = []
    plane = np.column_stack([np.ones(DOT_COUNT), dot_centres_u()])
    for least, below in pairwise(SIZE_EDGES_PX):
        squares = []
        for plate in np.unique(dots.plates[(dots.diameters_px >= least) & (dots.diameters_px < below)]):
            chosen = dots.plates == plate
            if chosen.sum() >= FEWEST_OF_PLATE:
                basis = np.linalg.qr(plane[dots.cells[chosen]]).Q
                modes = basis.T @ dots.errors_px[chosen]
                rest = np.square(dots.errors_px[chosen]).sum() - np.square(modes).sum()
                parts = np.square(modes[0]).mean(), np.square(modes[1:]).mean(), rest / (2 * (chosen.sum() - 3))
                squares.append(parts)
        if squares:
            shift, linear, rest = np.sqrt(np.mean(squares, axis=0))
            ratios = f"{shift / rest:.2f}", f"{linear / rest:.2f}"
            rows.append((f"{least:g}-{below:g}", str(len(squares)), *ratios, f"{rest:.4f}"))
    return rows


def _in_place(target: TargetObservation, plate: PlateInView) -> bool:
    away_px = np.linalg.norm(target.centre_px - plate.dots_px.mean(axis=0))
    return bool(away_px < SAME_PLACE_U * plate.px_per_u)


def _dots_of(target: TargetObservation, plate: PlateInView, number: int) -> tuple[npt.NDArray[Any], ...]:
    seen, inks = target.measured, np.full(DOT_COUNT, RED)
    inks[list(DIGIT_CELLS)] = digits_of_code(target.code)
    count = int(seen.sum())
    return (
        (target.centres_px - plate.dots_px)[seen],
        target.covariances_px2[seen],
        np.full(count, 2.0 * plate.px_per_u),
        np.full(count, plate.incidence_deg),
        inks[seen],
        np.flatnonzero(seen),
        np.full(count, number),
    )


def _of_room(folder: Path) -> Iterator[tuple[Detection, Sequence[PlateInView]]]:
    for part in ("survey", "locate"):
        for name, shot in true_shots(folder / part).shots.items():
            yield detect(read_photo(folder / part / name).bgr, family_by_name(FAMILY)), shot.plates


def _of_rendered(room: RenderedRoom, photos: int) -> Iterator[tuple[Detection, Sequence[PlateInView]]]:
    family, camera = family_by_name(FAMILY), phone_camera(*room.size_px)
    scene = build_room(RoomOptions(ROOM_SIZE_M, targets=TARGETS, u_m=room.u_m), family, room.seed)
    for index, station in enumerate(plan_stations(ROOM_SIZE_M, StationOptions(count=photos), room.seed)):
        photo = render(scene, camera, station, room.imaging, room.seed + index)
        whole = (target for target in photo.targets if target.whole and not target.wrong)
        plates = [PlateInView(one.code, one.px_per_u, one.incidence_deg, one.dots_px) for one in whole]
        yield detect(load_photo(photo.jpeg).bgr, family), plates


if __name__ == "__main__":
    sys.exit(main())
