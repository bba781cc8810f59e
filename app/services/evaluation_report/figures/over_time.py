"""Errors over time, in the plan and in height, before the reference's own uncertainty."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.look import CHI2_95_2D, FRAME, SIGMAS_95, WIDTH
from app.services.evaluation_report.reach import Reach, reach_of
from app.services.evaluation_report.thinning import Rows, extreme_rows, said, unbroken
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
GAP_STEPS = 5.0  # a line is broken where a step in time is so many times the usual one
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
        _Panel("horizontal error, m", errors.horizontal_m, across, 0.0),
        _Panel("vertical error, m", errors.vectors_m[:, 2], up, -1.0),
    )
    rows = extreme_rows(np.column_stack([panel.values_m for panel in panels]), MOST)
    unit, per_unit_s = _unit(float(np.ptp(errors.times_s)))
    shapes: list[Shape] = []
    reaches = []
    for index, panel in enumerate(panels):
        corner = CORNER + np.array([0.0, index * (SIZE[1] + BETWEEN)])
        axes, reach = _axes(panel, (errors.times_s - errors.times_s[0]) / per_unit_s, corner)
        reaches.append(reach)
        shapes += [*_ground(axes, panel, f"time, {unit}" if index else ""), *_series(axes, panel, (errors, rows), ink)]
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
    beyond = "".join(reach.said for reach in reaches)
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


def _series(axes: Axes, panel: _Panel, drawn: tuple[Errors, Rows], ink: Ink) -> list[Shape]:
    """The band below, the series, triangles for what lies beyond."""
    errors, rows = drawn
    span_s = float(np.ptp(errors.times_s)) or 1.0
    across = (errors.times_s - errors.times_s[0]) / span_s * axes.high[0]
    inside_m = np.clip(panel.values_m, axes.low[1], axes.high[1])
    places = axes.place(np.column_stack([across, inside_m]))
    shapes: list[Shape] = []
    steps_s = np.diff(errors.times_s)
    gap_s = GAP_STEPS * float(np.median(steps_s)) if len(steps_s) else np.inf
    for run in unbroken(errors.times_s, rows, gap_s):
        if panel.band_m is not None:
            shapes.append(_band(axes, across[run], panel.band_m[run]))
        shapes.append(Path(places[run], Pen(ink, LINE)))
    if len(errors) <= DOTS_UP_TO:
        shapes += [Ellipse(place, np.full(2, DOT), 0.0, Pen(ink, 0.0, filled=True)) for place in places]
    return shapes + _triangles(axes, places[rows], panel.values_m[rows], ink)


def _band(axes: Axes, across: Array, band_m: Array) -> Path:
    upper = np.column_stack([across, np.minimum(band_m, axes.high[1])])
    lower = np.column_stack([across, np.maximum(-band_m, axes.low[1])])
    return Path(axes.place(np.vstack([upper, lower[::-1]])), BAND, closed=True)


def _triangles(axes: Axes, places: Array, values_m: Array, ink: Ink) -> list[Shape]:
    pen = Pen(ink, 0.0, filled=True)
    above = [Path(place + BEYOND, pen, closed=True) for place in places[values_m > axes.high[1]]]
    below = [Path(place - BEYOND, pen, closed=True) for place in places[values_m < axes.low[1]]]
    return [*above, *below]
