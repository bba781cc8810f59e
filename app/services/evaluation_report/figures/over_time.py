"""Errors over time, in the plan and in height, before the reference's own uncertainty."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.figures.measures import HORIZONTAL, VERTICAL
from app.services.evaluation_report.look import CHI2_95_2D, FRAME, SIGMAS_95, WIDTH
from app.services.evaluation_report.reach import Reach, reach_of
from app.services.evaluation_report.thinning import Rows, extreme_rows, said, unbroken, usual_gap_s
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Ellipse, Ink, Path, Pen, Shape, line, rectangle
from app.services.reporting.figures.axes import Axes, digits_of_step, nice_step
from app.services.reporting.numbers import fixed
from app.trajectories.evaluation import Evaluation
from app.trajectories.metrics.errors import Errors

Array = npt.NDArray[np.float64]

CORNER = np.array([48.0, 10.0])
SIZE = np.array([WIDTH - 58.0, 100.0])
BETWEEN, FOOT = 16.0, 30.0
MOST = 2000  # pairs drawn: four a point
DOTS_UP_TO = 150  # pairs that are told apart: each has a dot
DOT = 1.4
ACROSS_STEPS, UP_STEPS = 6, 3
LINE, ZERO = 0.9, Pen("muted", 0.7)
BAND = Pen("band", 0.0, filled=True)
BEYOND = np.array([[0.0, 0.0], [2.6, 4.5], [-2.6, 4.5]])  # a triangle that points out of the frame
TITLE_LEFT = 38.0
UNITS = (("s", 1.0, 600.0), ("min", 60.0, 7200.0), ("h", 3600.0, np.inf))  # name, seconds, longest time shown in it


@dataclass(frozen=True)
class _Panel:
    """One series with the reference's uncertainty.

    Attributes
    ----------
    title : str
    values_m : ndarray of shape (K,)
    band_m : ndarray of shape (K,) or None
        95 % of the reference's error are smaller.
    low : float
        Lower end of the axis: -1 for a signed series, 0 for sizes; times the upper end.
    """

    title: str
    values_m: Array
    band_m: Array | None
    low: float


def over_time(evaluation: Evaluation, ink: Ink) -> Figure:
    """The horizontal size and the signed vertical error of each pair."""
    errors = evaluation.errors
    across, up = _bands_m(errors)
    panels = (
        _Panel(HORIZONTAL.title, errors.horizontal_m, across, 0.0),
        _Panel(VERTICAL.title, errors.vectors_m[:, 2], up, -1.0),
    )
    rows = extreme_rows(np.column_stack([panel.values_m for panel in panels]), MOST)
    unit, per_unit_s = _unit(float(np.ptp(errors.times_s)))
    shapes: list[Shape] = []
    reaches = []
    for index, panel in enumerate(panels):
        corner = CORNER + np.array([0.0, index * (SIZE[1] + BETWEEN)])
        axes, reach = _axes(panel, (errors.times_s - errors.times_s[0]) / per_unit_s, corner)
        reaches.append(reach)
        drawn = _Drawn(axes, errors, rows)
        shapes += [
            *drawn.band(panel),
            *_ground(axes, panel, f"time, {unit}" if index else ""),
            *drawn.series(panel, ink),
        ]
    height = float(CORNER[1] + 2 * SIZE[1] + BETWEEN + FOOT)
    description = f"Two curves over {fixed(float(np.ptp(errors.times_s)) / per_unit_s, 1)} {unit}."
    return Figure(
        Drawing(WIDTH, height, tuple(shapes)), _caption(reaches, across, said(len(rows), len(errors))), description
    )


def _caption(reaches: list[Reach], band_m: Array | None, thinned: str) -> str:
    band = (
        " The reference told no uncertainty."
        if band_m is None
        else " Grey: where 95 % of the reference's own errors lie (the longer semi-axis of its ellipse; 1.96 sigma)."
    )
    triangles = " Triangles point to them." if any(reach.beyond for reach in reaches) else ""
    words = HORIZONTAL.words, VERTICAL.words
    beyond = "".join(reach.said_of(part) for reach, part in zip(reaches, words, strict=True))
    series = "Errors over time since the first pair: size in the plan, and sign and size in height."
    return f"{series}{band}{beyond}{triangles}{thinned}"


def _unit(duration_s: float) -> tuple[str, float]:
    return next((name, seconds) for name, seconds, longest_s in UNITS if duration_s <= longest_s)


def _bands_m(errors: Errors) -> tuple[Array | None, Array | None]:
    """What 95 % of the reference's errors keep within, in the plan and in height."""
    covariances_m2 = errors.reference_covariances_m2
    if covariances_m2 is None:
        return None, None
    greatest_m2 = np.linalg.eigvalsh(covariances_m2[:, :2, :2])[:, -1]
    return np.sqrt(CHI2_95_2D * greatest_m2), SIGMAS_95 * np.sqrt(covariances_m2[:, 2, 2])


def _axes(panel: _Panel, times: Array, corner: Array) -> tuple[Axes, Reach]:
    reach = reach_of([np.abs(panel.values_m)])
    end = float(times[-1]) or 1.0  # a single moment has no span
    return Axes(np.array([0.0, panel.low * reach.end_m]), np.array([end, reach.end_m]), corner, SIZE), reach


def _ground(axes: Axes, panel: _Panel, across: str) -> list[Shape]:
    """What a series is drawn on."""
    step = nice_step(0.0, float(axes.high[0]), ACROSS_STEPS)
    up = nice_step(float(axes.low[1]), float(axes.high[1]), UP_STEPS)
    lines = axes.grid(0, step, digits_of_step(step))
    zero = axes.place(np.array([[axes.low[0], 0.0], [axes.high[0], 0.0]]))
    return [
        *(shape for shape in lines if across or isinstance(shape, Path)),  # numbers stand below the lower panel
        *axes.grid(1, up, digits_of_step(up)),
        line(zero[0], zero[1], ZERO),
        rectangle(axes.corner, axes.corner + axes.size, FRAME),
        *axes.titles(across, panel.title, TITLE_LEFT)[0 if across else 1 :],
    ]


@dataclass(frozen=True)
class _Drawn:
    """The pairs that a panel draws: its axes, all errors, and the rows of these that are left after thinning."""

    axes: Axes
    errors: Errors
    rows: Rows

    def band(self, panel: _Panel) -> list[Shape]:
        """The reference's uncertainty, below everything else."""
        if panel.band_m is None:
            return []
        return [_band(self.axes, self._across[run], panel.band_m[run]) for run in self._runs]

    def series(self, panel: _Panel, ink: Ink) -> list[Shape]:
        """The errors, and triangles for what lies beyond."""
        inside_m = np.clip(panel.values_m, self.axes.low[1], self.axes.high[1])
        places = self.axes.place(np.column_stack([self._across, inside_m]))
        lines = [Path(places[run], Pen(ink, LINE)) for run in self._runs]
        dotted = places if len(places) <= DOTS_UP_TO else places[:0]
        dots = [Ellipse(place, np.full(2, DOT), 0.0, Pen(ink, 0.0, filled=True)) for place in dotted]
        return [*lines, *dots, *_triangles(self.axes, places[self.rows], panel.values_m[self.rows], ink)]

    @property
    def _across(self) -> Array:
        """Along the axis of time, shape (K,)."""
        span_s = float(np.ptp(self.errors.times_s)) or 1.0  # of a single moment
        return np.asarray((self.errors.times_s - self.errors.times_s[0]) / span_s * self.axes.high[0])

    @property
    def _runs(self) -> list[Rows]:
        return unbroken(self.errors.times_s, self.rows, usual_gap_s(self.errors.times_s))


def _band(axes: Axes, across: Array, band_m: Array) -> Path:
    upper = np.column_stack([across, np.minimum(band_m, axes.high[1])])
    lower = np.column_stack([across, np.maximum(-band_m, axes.low[1])])
    return Path(axes.place(np.vstack([upper, lower[::-1]])), BAND, closed=True)


def _triangles(axes: Axes, places: Array, values_m: Array, ink: Ink) -> list[Shape]:
    pen = Pen(ink, 0.0, filled=True)
    above = [Path(place + BEYOND, pen, closed=True) for place in places[values_m > axes.high[1]]]
    below = [Path(place - BEYOND, pen, closed=True) for place in places[values_m < axes.low[1]]]
    return [*above, *below]
