"""The components of errors: where the system is wrong, and how it scatters about that."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.look import CHI2_95_2D, FRAME, WIDTH
from app.services.evaluation_report.numbers import error_m
from app.services.evaluation_report.reach import Reach, reach_of
from app.services.evaluation_report.thinning import distinct_rows
from app.services.evaluation_report.units import Unit, length_unit
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Ellipse, Ink, Path, Pen, Shape, line, rectangle
from app.services.reporting.figures.axes import Axes, digits_of_step, nice_step
from app.services.reporting.numbers import count
from app.trajectories.evaluation import Evaluation

Array = npt.NDArray[np.float64]

CORNER = np.array([48.0, 10.0])
BETWEEN = 64.0
SIDE = (WIDTH - CORNER[0] - BETWEEN - 16.0) / 2.0
FOOT = 34.0
STEPS = 4
DOT = 1.1  # radius of a point
MOST_DOTS, SPACING = 3000, 2.0  # of more dots those nearer than this are drawn as one
AXIS = Pen("muted", 0.7)
ELLIPSE, CROSS = Pen("ink", 1.4), Pen("ink", 1.6)
CROSS_REACH = 5.0
OUTLINE_POINTS = 241
TITLE_LEFT = 38.0
PLANES = ((0, 1), (0, 2))
AXES = "XYZ"


def components(evaluation: Evaluation, ink: Ink) -> Figure:
    """Errors along X and Y, and along X and Z, each with bias and covariance."""
    vectors_m = evaluation.errors.vectors_m
    reach = reach_of([np.abs(vectors_m).ravel()])
    unit = length_unit(reach.end)
    shapes: list[Shape] = []
    merges = False
    for panel, plane in enumerate(PLANES):
        corner = CORNER + np.array([panel * (SIDE + BETWEEN), 0.0])
        axes = Axes(np.full(2, -reach.end), np.full(2, reach.end), corner, np.full(2, SIDE), unit.per_base)
        dots = _dots(axes, vectors_m[:, plane], ink)
        merges |= len(dots) < int(_inside(axes, vectors_m[:, plane]).sum())
        shapes += [*_grid(axes, plane, unit), *dots, *_bias_and_spread(axes, evaluation, plane)]
    drawing = Drawing(WIDTH, float(CORNER[1]) + SIDE + FOOT, tuple(shapes))
    bias = ", ".join(error_m(value) for value in evaluation.accuracy.bias_m.tolist())
    description = f"Errors along the axes and their ellipse; bias {bias} m along X, Y, Z."
    return Figure(drawing, _caption(reach, merges, len(vectors_m)), description)


def _caption(reach: Reach, merges: bool, total: int) -> str:
    merged = f" Of {count(total)} points those that lie within {SPACING:g} pt are drawn as one."
    return (
        "Components of the errors (estimate minus reference) of all pairs: the cross is the bias, the ellipse, as "
        "far as the axes go, holds 95 % of a normal distribution of the errors' covariance."
        f"{reach.said_of('components')}{merged if merges else ''}"
    )


def _grid(axes: Axes, plane: tuple[int, int], unit: Unit) -> list[Shape]:
    step = nice_step(0.0, 2.0 * float(axes.high[0]), STEPS)
    digits = digits_of_step(step * unit.per_base)
    across, up = (f"{AXES[axis]} error, {unit.name}" for axis in plane)
    middle, right, top = axes.place(np.array([[0.0, 0.0], [axes.high[0], 0.0], [0.0, axes.high[1]]]))
    return [
        *axes.grid(0, step, digits),
        *axes.grid(1, step, digits),
        line(2 * middle - right, right, AXIS),
        line(2 * middle - top, top, AXIS),
        rectangle(axes.corner, axes.corner + axes.size, FRAME),
        *axes.titles(across, up, TITLE_LEFT),
    ]


def _dots(axes: Axes, vectors_m: Array, ink: Ink) -> list[Shape]:
    places = axes.place(vectors_m[_inside(axes, vectors_m)])
    if len(places) > MOST_DOTS:
        places = places[distinct_rows(places, SPACING)]
    return [Ellipse(place, np.full(2, DOT), 0.0, Pen(ink, 0.0, filled=True)) for place in places]


def _bias_and_spread(axes: Axes, evaluation: Evaluation, plane: tuple[int, int]) -> list[Shape]:
    """The cross at the mean, the ellipse around it."""
    accuracy, rows = evaluation.accuracy, list(plane)
    centre = axes.place(accuracy.bias_m[rows])
    values, vectors = np.linalg.eigh(accuracy.covariance_m2[np.ix_(rows, rows)])
    angles_rad = np.linspace(0.0, 2.0 * np.pi, OUTLINE_POINTS)
    circle = np.sqrt(CHI2_95_2D) * np.stack([np.cos(angles_rad), np.sin(angles_rad)], axis=-1)
    outline_m = accuracy.bias_m[rows] + circle * np.sqrt(np.maximum(values, 0.0)) @ vectors.T
    across, up = np.array([CROSS_REACH, 0.0]), np.array([0.0, CROSS_REACH])
    cross = [line(centre - arm, centre + arm, CROSS) for arm in (across, up)]
    return [*_within(axes, outline_m), *(cross if _inside(axes, accuracy.bias_m[rows]) else [])]


def _within(axes: Axes, outline_m: Array) -> list[Path]:
    """What the frame holds of an outline."""
    inside = _inside(axes, outline_m)
    runs = np.split(np.arange(len(inside)), np.flatnonzero(np.diff(inside)) + 1)
    return [Path(axes.place(outline_m[run]), ELLIPSE) for run in runs if inside[run[0]] and len(run) > 1]


def _inside(axes: Axes, places_m: Array) -> npt.NDArray[np.bool_]:
    return np.asarray(((places_m >= axes.low) & (places_m <= axes.high)).all(axis=-1))
