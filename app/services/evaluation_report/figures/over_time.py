"""Errors over time, in the plan, in height and of orientation, before the reference's own uncertainty."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.figures.measures import HORIZONTAL, ROTATION, VERTICAL, Measure
from app.services.evaluation_report.look import CHI2_95_2D, CHI2_95_3D, FRAME, SIGMAS_95, WIDTH
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
SIZE = np.array([WIDTH - 64.0, 100.0])
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
    measure : Measure
    values : ndarray of shape (K,)
        In the measure's unit.
    band : ndarray of shape (K,) or None
        95 % of the reference's error are smaller.
    low : float
        Lower end of the axis: -1 for a signed series, 0 for sizes; times the upper end.
    """

    measure: Measure
    values: Array
    band: Array | None
    low: float


def over_time(evaluation: Evaluation, ink: Ink) -> Figure:
    """The horizontal size, the signed vertical error and, if known, the angle of each pair."""
    errors, panels = evaluation.errors, _panels(evaluation)
    rows = extreme_rows(np.column_stack([panel.values for panel in panels]), MOST)
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
            *_ground(axes, panel, f"time, {unit}" if index == len(panels) - 1 else ""),
            *drawn.series(panel, ink),
        ]
    height = float(CORNER[1] + len(panels) * (SIZE[1] + BETWEEN) - BETWEEN + FOOT)
    description = f"{len(panels)} curves over {fixed(float(np.ptp(errors.times_s)) / per_unit_s, 1)} {unit}."
    return Figure(
        Drawing(WIDTH, height, tuple(shapes)), _caption(panels, reaches, said(len(rows), len(errors))), description
    )


def _panels(evaluation: Evaluation) -> tuple[_Panel, ...]:
    errors = evaluation.errors
    across, up = _bands_m(errors)
    panels = (
        _Panel(HORIZONTAL, errors.horizontal_m, across, 0.0),
        _Panel(VERTICAL, errors.vectors_m[:, 2], up, -1.0),
    )
    angles_deg = ROTATION.of(evaluation)
    return (*panels, _Panel(ROTATION, angles_deg, _band_deg(evaluation), 0.0)) if len(angles_deg) else panels


def _caption(panels: tuple[_Panel, ...], reaches: list[Reach], thinned: str) -> str:
    band = (
        " The reference told no uncertainty."
        if panels[0].band is None
        else " Grey: where 95 % of the reference's own errors lie (longest semi-axis of its ellipse; 1.96 sigma in "
        "height)."
    )
    triangles = " Triangles point to them." if any(reach.beyond for reach in reaches) else ""
    measures = [panel.measure for panel in panels]
    beyond = "".join(
        reach.said_of(measure.words, measure.unit.name) for reach, measure in zip(reaches, measures, strict=True)
    )
    turned = "; angle of rotation" if ROTATION in measures else ""
    series = f"Errors over time since the first pair: size in the plan; sign and size in height{turned}."
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


def _band_deg(evaluation: Evaluation) -> Array | None:
    """What 95 % of the angles of the reference's own rotations keep within."""
    covariances = evaluation.pairs.reference.covariances
    if covariances is None:
        return None
    greatest_rad2 = np.linalg.eigvalsh(covariances[:, 3:, 3:])[:, -1]
    return np.asarray(np.degrees(np.sqrt(CHI2_95_3D * greatest_rad2)))


def _axes(panel: _Panel, times: Array, corner: Array) -> tuple[Axes, Reach]:
    reach = reach_of([np.abs(panel.values)])
    end = float(times[-1]) or 1.0  # a single moment has no span
    return Axes(np.array([0.0, panel.low * reach.end]), np.array([end, reach.end]), corner, SIZE), reach


def _ground(axes: Axes, panel: _Panel, across: str) -> list[Shape]:
    """What a series is drawn on."""
    step = nice_step(0.0, float(axes.high[0]), ACROSS_STEPS)
    up = nice_step(float(axes.low[1]), float(axes.high[1]), UP_STEPS)
    unit = panel.measure.unit_up_to(float(axes.high[1]))
    lines = axes.grid(0, step, digits_of_step(step))
    zero = axes.place(np.array([[axes.low[0], 0.0], [axes.high[0], 0.0]]))
    return [
        *(shape for shape in lines if across or isinstance(shape, Path)),  # numbers stand below the lower panel
        *replace(axes, written=unit.per_base).grid(1, up, digits_of_step(up * unit.per_base)),
        line(zero[0], zero[1], ZERO),
        rectangle(axes.corner, axes.corner + axes.size, FRAME),
        *axes.titles(across, panel.measure.along(unit), TITLE_LEFT)[0 if across else 1 :],
    ]


@dataclass(frozen=True)
class _Drawn:
    """The pairs that a panel draws: its axes, all errors, and the rows of these that are left after thinning."""

    axes: Axes
    errors: Errors
    rows: Rows

    def band(self, panel: _Panel) -> list[Shape]:
        """The reference's uncertainty, below everything else."""
        if panel.band is None:
            return []
        return [_band(self.axes, self._across[run], panel.band[run]) for run in self._runs]

    def series(self, panel: _Panel, ink: Ink) -> list[Shape]:
        """The errors, and triangles for what lies beyond."""
        inside = np.clip(panel.values, self.axes.low[1], self.axes.high[1])
        places = self.axes.place(np.column_stack([self._across, inside]))
        lines = [Path(places[run], Pen(ink, LINE)) for run in self._runs]
        dotted = places if len(places) <= DOTS_UP_TO else places[:0]
        dots = [Ellipse(place, np.full(2, DOT), 0.0, Pen(ink, 0.0, filled=True)) for place in dotted]
        return [*lines, *dots, *_triangles(self.axes, places[self.rows], panel.values[self.rows], ink)]

    @property
    def _across(self) -> Array:
        """Along the axis of time, shape (K,)."""
        span_s = float(np.ptp(self.errors.times_s)) or 1.0  # of a single moment
        return np.asarray((self.errors.times_s - self.errors.times_s[0]) / span_s * self.axes.high[0])

    @property
    def _runs(self) -> list[Rows]:
        return unbroken(self.errors.times_s, self.rows, usual_gap_s(self.errors.times_s))


def _band(axes: Axes, across: Array, band: Array) -> Path:
    upper = np.column_stack([across, np.minimum(band, axes.high[1])])
    lower = np.column_stack([across, np.maximum(-band, axes.low[1])])
    return Path(axes.place(np.vstack([upper, lower[::-1]])), BAND, closed=True)


def _triangles(axes: Axes, places: Array, values: Array, ink: Ink) -> list[Shape]:
    pen = Pen(ink, 0.0, filled=True)
    above = [Path(place + BEYOND, pen, closed=True) for place in places[values > axes.high[1]]]
    below = [Path(place - BEYOND, pen, closed=True) for place in places[values < axes.low[1]]]
    return [*above, *below]
