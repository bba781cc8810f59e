"""Box plots: all systems beside each other, everywhere and in each zone."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.figures.measures import SPATIAL
from app.services.evaluation_report.look import FRAME, WIDTH, pens, short
from app.services.evaluation_report.material import ReportMaterial
from app.services.evaluation_report.reach import Reach, reach_of
from app.services.evaluation_report.thinning import distinct_rows
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Ellipse, Ink, Label, Path, Pen, Shape, line, rectangle
from app.services.reporting.figures.axes import Axes, digits_of_step, nice_step
from app.services.reporting.figures.labels import LETTER_WIDTH
from app.services.reporting.numbers import count
from app.trajectories.metrics.zones import rows_by_zone

Array = npt.NDArray[np.float64]

TOP, RIGHT, FOOT = 6.0, 16.0, 34.0
LEAST_LEFT, NAME_GAP = 60.0, 8.0
ROW, GROUP_GAP = 17.0, 8.0
BOX, CAP = 5.0, 3.0  # half heights
NAME_SIZE = 7.0
STEPS = 6
SHARES = (0.05, 0.25, 0.5, 0.75, 0.95)
THIN, MEDIAN = 0.9, 2.2  # strokes
MEAN = 2.0  # half a diagonal of the diamond
DOT, SPACING = 0.9, 1.0  # of a point beyond the whiskers; points nearer than this are drawn as one
EVERYWHERE = ""


@dataclass(frozen=True)
class _Row:
    """One box: zone, system, its colour, sizes of errors of shape (K,)."""

    zone: str
    name: str
    ink: Ink
    sizes_m: Array

    @property
    def label(self) -> str:
        zone = "" if self.zone == EVERYWHERE else f"{short(self.zone)} · "
        return f"{zone}{short(self.name)} ({count(len(self.sizes_m))})"


def boxes(material: ReportMaterial) -> Figure:
    """Errors in space by zone and system."""
    rows = _rows(material)
    reach = _reach(rows)
    left = max(LEAST_LEFT, NAME_GAP + LETTER_WIDTH * NAME_SIZE * max(len(row.label) for row in rows))
    tops = _tops(rows)
    size = np.array([WIDTH - left - RIGHT, tops[-1] + ROW])
    axes = Axes(
        np.zeros(2), np.array([reach.end, 1.0]), np.array([left, TOP]), size, SPATIAL.unit_up_to(reach.end).per_base
    )
    shapes = _ground(axes)
    for row, top in zip(rows, tops, strict=True):
        shapes += _box(axes, row, TOP + top + ROW / 2.0)
    by = "zone and system" if material.zones else "system"
    caption = (
        f"Errors in space by {by} (pairs): box from the first to the third quartile, heavy line at the median, diamond "
        f"at the mean, whiskers from 5 to 95 %, points beyond them.{reach.said_of(SPATIAL.words)}"
    )
    drawing = Drawing(WIDTH, TOP + float(size[1]) + FOOT, tuple(shapes))
    return Figure(drawing, caption, f"{len(rows)} boxes: {'; '.join(row.label for row in rows)}.")


def _rows(material: ReportMaterial) -> list[_Row]:
    """Everywhere first, then zone by zone."""
    rows: dict[str, list[_Row]] = {EVERYWHERE: []}
    for name, pen in pens(list(material.evaluations)).items():
        evaluation = material.evaluations[name]
        sizes_m = SPATIAL.of(evaluation)
        rows[EVERYWHERE].append(_Row(EVERYWHERE, name, pen.ink, sizes_m))
        for zone, inside in rows_by_zone(evaluation.pairs.reference.positions_m, material.zones).items():
            rows.setdefault(zone, []).append(_Row(zone, name, pen.ink, sizes_m[inside]))
    return [row for zone in rows.values() for row in zone]


def _reach(rows: list[_Row]) -> Reach:
    """The axis for all boxes; an error that is in a zone as well is counted once."""
    reach = reach_of([row.sizes_m for row in rows])
    beyond = sum(int((row.sizes_m > reach.end).sum()) for row in rows if row.zone == EVERYWHERE)
    return replace(reach, beyond=beyond)


def _tops(rows: list[_Row]) -> list[float]:
    """Upper edges of the rows, zones parted by a gap."""
    tops: list[float] = []
    top = GROUP_GAP / 2.0
    for index, row in enumerate(rows):
        if index and rows[index - 1].zone != row.zone:
            top += GROUP_GAP
        tops.append(top)
        top += ROW
    return tops


def _ground(axes: Axes) -> list[Shape]:
    step = nice_step(0.0, float(axes.high[0]), STEPS)
    unit = SPATIAL.unit_up_to(float(axes.high[0]))
    across, _ = axes.titles(SPATIAL.along(unit), "", 0.0)
    frame = rectangle(axes.corner, axes.corner + axes.size, FRAME)
    return [*axes.grid(0, step, digits_of_step(step * unit.per_base)), frame, across]


def _box(axes: Axes, row: _Row, middle: float) -> list[Shape]:
    levels_m = np.quantile(row.sizes_m, SHARES)
    low, first, median, third, high = _across(axes, levels_m)
    stroke, heavy = Pen(row.ink, THIN), Pen(row.ink, MEDIAN)
    box, cap = np.array([0.0, BOX]), np.array([0.0, CAP])
    at = [np.array([x, middle]) for x in (low, first, median, third, high)]
    name = Label(
        np.array([axes.corner[0] - NAME_GAP / 2.0, middle + 0.35 * NAME_SIZE]), row.label, "ink", NAME_SIZE, "end"
    )
    return [
        name,
        *_beyond(axes, row, (levels_m[0], levels_m[-1]), middle),
        line(at[0], at[1], stroke),
        line(at[3], at[4], stroke),
        line(at[0] - cap, at[0] + cap, stroke),
        line(at[4] - cap, at[4] + cap, stroke),
        rectangle(at[1] - box, at[3] + box, stroke),
        line(at[2] - box, at[2] + box, heavy),
        _diamond(axes, row, middle),
    ]


def _across(axes: Axes, sizes_m: Array) -> Array:
    """Where sizes, shape (N,), stand along the axis, those beyond it at its end."""
    inside = np.minimum(sizes_m, axes.high[0])
    return np.asarray(axes.place(np.column_stack([inside, np.zeros_like(inside)]))[:, 0])


def _diamond(axes: Axes, row: _Row, middle: float) -> Path:
    """The mean."""
    (x,) = _across(axes, np.array([row.sizes_m.mean()]))
    corners = MEAN * np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
    return Path(np.array([x, middle]) + corners, Pen(row.ink, THIN, filled=True), closed=True)


def _beyond(axes: Axes, row: _Row, whiskers_m: tuple[float, float], middle: float) -> list[Shape]:
    outside = (row.sizes_m < whiskers_m[0]) | (row.sizes_m > whiskers_m[1])
    sizes_m = row.sizes_m[outside & (row.sizes_m <= axes.high[0])]
    places = np.column_stack([_across(axes, sizes_m), np.full(len(sizes_m), middle)])
    pen = Pen(row.ink, 0.0, filled=True)
    return [Ellipse(place, np.full(2, DOT), 0.0, pen) for place in places[distinct_rows(places, SPACING)]]
