"""The plan: the reference's path, and from it the errors, coloured by their size."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.figures.plan_key import SIZES, ClassScale, plan_key, plan_key_height
from app.services.evaluation_report.look import FRAME, WIDTH
from app.services.evaluation_report.thinning import Rows, distinct_rows, moved_rows, spread_rows, unbroken, usual_gap_s
from app.services.evaluation_report.units import length_unit
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Ellipse, Label, Path, Pen, Shape, arrow, line, rectangle
from app.services.reporting.figures.axes import digits_of_step, nice_step, plan_axes
from app.services.reporting.figures.labels import legible
from app.services.reporting.numbers import count, fixed, nice_below
from app.trajectories.evaluation import Evaluation
from app.trajectories.metrics.zones import Zone

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class PlanOptions:
    """How the plan is drawn.

    Attributes
    ----------
    height : float
        Of the frame at most, points: the plan, the key and another figure fit a page.
    vector : float
        Length of a long error (95 of 100 are shorter), points: its direction is seen, its neighbours are not hidden.
    most_vectors, most_great : int
        Errors that are drawn, spread over the walk, and the greatest beside them: more would cover each other.
    most_places : int
        Of the path's line, to the point. A longer one has been over its own ground: that is drawn as dots.
    dots_up_to : int
        Pairs up to which each place of the reference has a dot.
    """

    height: float = 400.0
    vector: float = 26.0
    most_vectors: int = 600
    most_great: int = 100
    most_places: int = 6000
    dots_up_to: int = 400


CORNER = np.array([48.0, 10.0])
RIGHT = 16.0
FOOT = 34.0
USUAL = 0.95
LEAST_STEP_M = 1e-4  # between classes: what tables still tell
ROUNDING = 1e-9  # of a step that is round already
GRID_COUNT = 5
TITLE_LEFT = 38.0
PATH, START = Pen("muted", 0.8), Pen("ink", 1.2)
DOT, START_RADIUS, HEAD = 1.2, 3.2, 2.6
PATH_SPACING = 0.7  # points: what a line that is as wide does not show
ZONE = Pen("muted", 0.8, dash=(4.0, 2.5))
ZONE_NAME = 7.0


def plan_view(evaluation: Evaluation, zones: tuple[Zone, ...], options: PlanOptions = PlanOptions()) -> Figure:
    """One system's errors in the plan."""
    plan = _Plan(evaluation, zones, options)
    below = plan.axes.corner[1] + plan.axes.size[1] + FOOT
    at = np.array([CORNER[0], below + ZONE_NAME])
    width = WIDTH - CORNER[0] - RIGHT
    scale = ClassScale(plan.limits_m, plan.enlargement, float(plan.axes.points_per_unit[0]))
    shapes = (*plan.shapes(), *plan_key(at, width, scale))
    drawing = Drawing(WIDTH, float(at[1]) + plan_key_height(width, scale), shapes)
    return Figure(drawing, plan.caption(), plan.description())


def class_limits_m(sizes_m: Array) -> Array:
    """Four limits between five classes of errors: equal steps of one digit, the last near the 95 % quantile."""
    classes = len(SIZES)
    step_m = max(float(np.quantile(sizes_m, USUAL)) / classes, LEAST_STEP_M)
    power = 10.0 ** np.floor(np.log10(step_m))
    return np.arange(1, classes, dtype=np.float64) * float(np.ceil(step_m / power - ROUNDING) * power)


class _Plan:
    """What the plan's parts have in common."""

    def __init__(self, evaluation: Evaluation, zones: tuple[Zone, ...], options: PlanOptions) -> None:
        self.errors = evaluation.errors
        self.places_m = evaluation.pairs.reference.positions_m[:, :2]
        self.zones, self.options = zones, options
        sizes_m = self.errors.horizontal_m
        usual_m = float(np.quantile(sizes_m, USUAL))
        tips_m = (self.places_m + self.errors.vectors_m[:, :2])[sizes_m <= usual_m]
        extent_m = np.concatenate([self.places_m, tips_m, *(zone.corners_m for zone in zones)])
        self.axes = plan_axes(extent_m, CORNER, np.array([WIDTH - CORNER[0] - RIGHT, options.height]))
        self.unit = length_unit(float(np.abs([self.axes.low, self.axes.high]).max()))
        length = usual_m * float(self.axes.points_per_unit[0])
        self.enlargement = max(1.0, nice_below(options.vector / length)) if length > 0 else 1.0
        self.limits_m = class_limits_m(sizes_m)
        self.rows = spread_rows(sizes_m, options.most_vectors, options.most_great)
        self.tips = self._tips(self.rows)

    def shapes(self) -> list[Shape]:
        """All of the plan, the errors on top, the greatest last."""
        return [*self._ground(), *self._zones(), *self._path(), *self._vectors()]

    def caption(self) -> str:
        cut = int((self.tips[1] < 1.0).sum())
        enlarged = f"enlarged {count(round(self.enlargement))} times" if self.enlargement > 1 else "true to scale"
        ended = "" if cut == 0 else f" {count(cut)} of them end at the frame, without a head."
        thinned = self._thinned()
        return (
            "Plan view: the reference's path (grey, from the circle) and the errors in the plan (arrows from the "
            f"reference to the estimate, {enlarged}), coloured by size.{ended}{thinned}"
        )

    def _thinned(self) -> str:
        """The sentence for what is not drawn."""
        if len(self.rows) == len(self.errors):
            return ""
        drawn, total, great = count(len(self.rows)), count(len(self.errors)), count(self.options.most_great)
        return f" Of {total} errors {drawn} are drawn: evenly over the walk, and the {great} greatest."

    def description(self) -> str:
        """The plan for those who do not see it."""
        (x0, y0), (x1, y1) = self.axes.low, self.axes.high
        return (
            f"{count(len(self.rows))} arrows between X {fixed(x0, 1)} and {fixed(x1, 1)} m and Y {fixed(y0, 1)} and "
            f"{fixed(y1, 1)} m, with {len(self.zones)} zones."
        )

    def _ground(self) -> list[Shape]:
        step = nice_step(0.0, float((self.axes.high - self.axes.low).max()), GRID_COUNT)
        axes = replace(self.axes, written=self.unit.per_base)
        digits = digits_of_step(step * self.unit.per_base)
        return [
            *axes.grid(0, step, digits),
            *axes.grid(1, step, digits),
            rectangle(self.axes.corner, self.axes.corner + self.axes.size, FRAME),
            *self.axes.titles(f"X, {self.unit.name}", f"Y, {self.unit.name}", TITLE_LEFT),
        ]

    def _zones(self) -> list[Shape]:
        outlines, names = [], []
        for zone in self.zones:
            corners = self.axes.place(zone.corners_m)
            highest = corners[np.lexsort((corners[:, 0], corners[:, 1]))[0]]
            outlines.append(Path(corners, ZONE, closed=True))
            names.append(Label(highest + np.array([4.0, ZONE_NAME + 3.0]), zone.name, "muted", ZONE_NAME))
        return [*outlines, *legible(names)]

    def _path(self) -> list[Shape]:
        """The reference, broken where it was away."""
        times_s = self.errors.times_s
        places = self.axes.place(self.places_m)
        rows = moved_rows(places, PATH_SPACING)
        runs, dots = unbroken(times_s, rows, usual_gap_s(times_s)), places[:0]
        if len(rows) > self.options.most_places:
            runs, dots = [], places[distinct_rows(places, PATH_SPACING)]
        elif len(places) <= self.options.dots_up_to:
            dots = places
        return [
            *(Path(places[run], PATH) for run in runs),
            *(Ellipse(place, np.full(2, DOT), 0.0, Pen("muted", 0.0, filled=True)) for place in dots),
            Ellipse(places[0], np.full(2, START_RADIUS), 0.0, START),
        ]

    def _tips(self, rows: Rows) -> tuple[Array, Array]:
        """Steps on the sheet, shape (N, 2), and the share of each that lies within the frame, shape (N,)."""
        steps = self.enlargement * self.errors.vectors_m[rows, :2] * self.axes.points_per_unit * np.array([1.0, -1.0])
        start = self.axes.place(self.places_m[rows])
        room = np.where(steps > 0, self.axes.corner + self.axes.size - start, start - self.axes.corner)
        share = np.divide(room, np.abs(steps), out=np.ones_like(steps), where=np.abs(steps) > room)
        return steps, share.min(axis=1)

    def _vectors(self) -> list[Shape]:
        sizes_m = self.errors.horizontal_m[self.rows]
        classes = np.searchsorted(self.limits_m, sizes_m)
        steps, shares = self.tips
        starts = self.axes.place(self.places_m[self.rows])
        shapes: list[Shape] = []
        for index in np.argsort(sizes_m):
            pen = ClassScale.pen(int(classes[index]))
            if shares[index] == 1.0:
                shapes.extend(arrow(starts[index], steps[index], pen, HEAD))
            else:
                shapes.append(line(starts[index], starts[index] + shares[index] * steps[index], pen))
        return shapes
