"""Cumulative distributions: which share of a system's errors is how small."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.figures.measures import HORIZONTAL, ROTATION, SPATIAL, VERTICAL, Measure
from app.services.evaluation_report.look import FRAME, WIDTH, pens, short
from app.services.evaluation_report.numbers import PERCENT
from app.services.evaluation_report.reach import Reach, reach_of
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Ellipse, Label, Path, Pen, Shape, line, rectangle
from app.services.reporting.figures.axes import Axes, digits_of_step, nice_step
from app.services.reporting.figures.key import key, key_height
from app.trajectories.evaluation import Evaluation

Array = npt.NDArray[np.float64]
Evaluations = Mapping[str, Evaluation]

CORNER = np.array([44.0, 10.0])
HEIGHT, SMALL_HEIGHT = 200.0, 130.0
RIGHT = 24.0  # of a panel: names of levels
FOOT = 44.0  # below a panel: numbers, title, key
BETWEEN = 62.0
BELOW_KEY = 8.0  # of the last line of the key nothing stands below the baseline
MOST_POINTS = 1001  # of a curve: every 0.1 %
LINES = (0.5, 0.75, 0.95)
LINE = Pen("muted", 0.6, dash=(2.0, 2.0))
LEAST_STEP, UP_STEP = 55.0, 25.0  # points between numbers across, twice as many at most; percent
MARK_RADIUS = 2.2
TITLE_LEFT = 32.0


def cumulative_spatial(evaluations: Evaluations) -> Figure:
    """The errors in space of all systems, with the lines of 50, 75 and 95 %."""
    size = np.array([WIDTH - CORNER[0] - RIGHT, HEIGHT])
    panel, reach = _panel(evaluations, SPATIAL, (CORNER, size))
    return _figure(pens(list(evaluations)), panel, HEIGHT, _caption((SPATIAL,), (reach,)))


def cumulative_parts(evaluations: Evaluations) -> Figure:
    """The same for the plan and for heights, side by side."""
    size = np.array([(WIDTH - CORNER[0] - RIGHT - BETWEEN) / 2.0, SMALL_HEIGHT])
    beside = CORNER + np.array([size[0] + BETWEEN, 0.0])
    left, plan = _panel(evaluations, HORIZONTAL, (CORNER, size))
    right, heights = _panel(evaluations, VERTICAL, (beside, size))
    return _figure(
        pens(list(evaluations)), [*left, *right], SMALL_HEIGHT, _caption((HORIZONTAL, VERTICAL), (plan, heights))
    )


def cumulative_rotation(evaluations: Evaluations) -> Figure | None:
    """The errors of orientation of those systems that told any; None when none did."""
    turned = [name for name, found in evaluations.items() if len(ROTATION.of(found))]
    if not turned:
        return None
    size = np.array([WIDTH - CORNER[0] - RIGHT, SMALL_HEIGHT])
    panel, reach = _panel(evaluations, ROTATION, (CORNER, size))
    strokes = {name: pen for name, pen in pens(list(evaluations)).items() if name in turned}
    return _figure(strokes, panel, SMALL_HEIGHT, _caption((ROTATION,), (reach,)))


def _figure(strokes: Mapping[str, Pen], panels: list[Shape], height: float, caption: str) -> Figure:
    entries = [(pen, short(name)) for name, pen in strokes.items()]
    at = CORNER + np.array([0.0, height + FOOT])
    width = WIDTH - CORNER[0] - RIGHT
    lower = float(at[1]) + key_height(width, entries) - BELOW_KEY
    drawing = Drawing(WIDTH, lower, (*panels, *key(at, width, entries)))
    names = ", ".join(strokes)
    return Figure(drawing, caption, f"Curves of the share of errors below each size for {names}.")


def _caption(measures: tuple[Measure, ...], reaches: tuple[Reach, ...]) -> str:
    which = " and of ".join(measure.words for measure in measures)
    far = (reach.said_of(measure.words, measure.unit.name) for measure, reach in zip(measures, reaches, strict=True))
    return f"Cumulative distribution of {which}; circles where a curve meets 50, 75 and 95 %.{''.join(far)}"


def _panel(evaluations: Evaluations, measure: Measure, frame: tuple[Array, Array]) -> tuple[list[Shape], Reach]:
    told = {name: measure.of(evaluation) for name, evaluation in evaluations.items()}
    series = {name: sizes for name, sizes in told.items() if len(sizes)}
    reach = reach_of(list(series.values()))
    unit = measure.unit_up_to(reach.end)
    axes = Axes(np.zeros(2), np.array([reach.end, PERCENT]), *frame)
    across = replace(axes, written=unit.per_base)
    step = nice_step(0.0, reach.end, round(float(axes.size[0]) / LEAST_STEP))
    shapes: list[Shape] = [
        *across.grid(0, step, digits_of_step(step * unit.per_base)),
        *axes.grid(1, UP_STEP, 0),
        *(shape for share in LINES for shape in _line(axes, share)),
        rectangle(axes.corner, axes.corner + axes.size, FRAME),
        *axes.titles(measure.along(unit), "share of pairs, %", TITLE_LEFT),
    ]
    for name, pen in pens(list(evaluations)).items():
        shapes += _curve(axes, series[name], pen) if name in series else []
    return shapes, reach


def _line(axes: Axes, share: float) -> list[Shape]:
    """A level across the panel, named to its right, where no curve passes."""
    ends = axes.place(np.array([[0.0, PERCENT * share], [axes.high[0], PERCENT * share]]))
    name = Label(ends[1] + np.array([3.0, 2.3]), f"{PERCENT * share:.0f} %", "muted", 6.5)
    return [line(ends[0], ends[1], LINE), name]


def _curve(axes: Axes, sizes: Array, pen: Pen) -> list[Shape]:
    """Quantiles of type 7, those of the tables, up to the end of the axis."""
    end = float(axes.high[0])
    shares = np.linspace(0.0, 1.0, min(len(sizes), MOST_POINTS)) if len(sizes) > 1 else np.array([0.0, 1.0])
    quantiles = np.quantile(sizes, shares)
    last = float(np.interp(end, quantiles, shares))
    inside = quantiles < end
    until = min(end, float(quantiles[-1]))
    course = np.column_stack([quantiles[inside], shares[inside]])
    points = np.vstack([[0.0, 0.0], course, [until, last], [end, last]])  # before the least nothing, after it all
    at_lines = np.column_stack([np.quantile(sizes, LINES), LINES])
    marks = [
        Ellipse(axes.place(_percent(mark)), np.full(2, MARK_RADIUS), 0.0, Pen(pen.ink, pen.width))
        for mark in at_lines
        if mark[0] <= end
    ]
    return [Path(axes.place(_percent(points)), pen), *marks]


def _percent(points: Array) -> Array:
    return points * np.array([1.0, PERCENT])
