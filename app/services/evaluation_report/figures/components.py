"""The components of errors: where the system is wrong, and how it scatters about that."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.look import CHI2_95_2D, FRAME, WIDTH
from app.services.evaluation_report.numbers import error_m
from app.services.evaluation_report.reach import Reach, reach_of
from app.services.evaluation_report.thinning import distinct_rows
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Ellipse, Ink, Pen, Shape, line, rectangle
from app.services.reporting.figures.axes import Axes, digits_of_step, nice_step
from app.services.reporting.numbers import count
from app.trajectories.evaluation import Evaluation

Array = npt.NDArray[np.float64]

CORNER = np.array([48.0, 10.0])
BETWEEN = 64.0
SIDE = (WIDTH - CORNER[0] - BETWEEN - 10.0) / 2.0
FOOT = 34.0
STEPS = 4
DOT = 1.1  # radius of a point
SPACING = 0.8  # points nearer than this are drawn as one
AXIS = Pen("muted", 0.7)
ELLIPSE, CROSS = Pen("ink", 1.4), Pen("ink", 1.6)
CROSS_REACH = 5.0
TITLE_LEFT = 38.0
PLANES = ((0, 1), (0, 2))
AXES = "XYZ"


def components(evaluation: Evaluation, ink: Ink) -> Figure:
    """Errors along X and Y, and along X and Z, each with bias and covariance."""
    vectors_m = evaluation.errors.vectors_m
    reach = reach_of([np.abs(vectors_m).ravel()])
    shapes: list[Shape] = []
    shown = []
    for panel, plane in enumerate(PLANES):
        corner = CORNER + np.array([panel * (SIDE + BETWEEN), 0.0])
        axes = Axes(np.full(2, -reach.end_m), np.full(2, reach.end_m), corner, np.full(2, SIDE))
        dots = _dots(axes, vectors_m[:, plane], ink)
        shown.append(len(dots))
        shapes += [*_grid(axes, plane), *dots, *_bias_and_spread(axes, evaluation, plane)]
    drawing = Drawing(WIDTH, float(CORNER[1]) + SIDE + FOOT, tuple(shapes))
    bias = ", ".join(error_m(value) for value in evaluation.accuracy.bias_m.tolist())
    description = f"{count(shown[0])} points of errors in the plan and their ellipse; bias {bias} m along X, Y, Z."
    return Figure(drawing, _caption(reach, min(shown), len(vectors_m)), description)


def _caption(reach: Reach, shown: int, total: int) -> str:
    merged = (
        f" Where points lie closer than {SPACING:g} pt one stands for all, so that {count(shown)} of {count(total)} or "
        "more are drawn, the outermost among them."
    )
    return (
        "Components of the errors (estimate minus reference) of all pairs: the cross is the bias, the ellipse holds "
        "95 % of a normal distribution of the errors' covariance."
        f"{reach.said.replace('errors', 'components')}{merged if shown < total - reach.beyond else ''}"
    )


def _grid(axes: Axes, plane: tuple[int, int]) -> list[Shape]:
    step = nice_step(0.0, 2.0 * float(axes.high[0]), STEPS)
    across, up = (f"{AXES[axis]} error, m" for axis in plane)
    middle, right, top = axes.place(np.array([[0.0, 0.0], [axes.high[0], 0.0], [0.0, axes.high[1]]]))
    return [
        *axes.grid(0, step, digits_of_step(step)),
        *axes.grid(1, step, digits_of_step(step)),
        line(2 * middle - right, right, AXIS),
        line(2 * middle - top, top, AXIS),
        rectangle(axes.corner, axes.corner + axes.size, FRAME),
        *axes.titles(across, up, TITLE_LEFT),
    ]


def _dots(axes: Axes, vectors_m: Array, ink: Ink) -> list[Shape]:
    places = axes.place(vectors_m[(np.abs(vectors_m) <= axes.high).all(axis=1)])
    pen = Pen(ink, 0.0, filled=True)
    return [Ellipse(place, np.full(2, DOT), 0.0, pen) for place in places[distinct_rows(places, SPACING)]]


def _bias_and_spread(axes: Axes, evaluation: Evaluation, plane: tuple[int, int]) -> list[Shape]:
    """The cross at the mean, the ellipse around it."""
    accuracy, rows = evaluation.accuracy, list(plane)
    centre = axes.place(accuracy.bias_m[rows])
    values, vectors = np.linalg.eigh(accuracy.covariance_m2[np.ix_(rows, rows)])
    semi_axes = np.sqrt(CHI2_95_2D * np.maximum(values[::-1], 0.0)) * axes.points_per_unit[0]
    turn_deg = -float(np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1])))  # on the sheet y points down
    across, up = np.array([CROSS_REACH, 0.0]), np.array([0.0, CROSS_REACH])
    return [
        Ellipse(centre, semi_axes, turn_deg, ELLIPSE),
        line(centre - across, centre + across, CROSS),
        line(centre - up, centre + up, CROSS),
    ]
