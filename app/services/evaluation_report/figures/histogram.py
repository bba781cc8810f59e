"""How often errors are how large."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.services.evaluation_report.figures.measures import SPATIAL
from app.services.evaluation_report.look import FRAME, WIDTH
from app.services.evaluation_report.numbers import error_m
from app.services.evaluation_report.reach import reach_of
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Ink, Label, Pen, Shape, line, rectangle
from app.services.reporting.figures.axes import Axes, digits_of_step, nice_step
from app.services.reporting.figures.labels import LETTER_WIDTH
from app.services.reporting.numbers import count, fixed, nice_below
from app.trajectories.evaluation import Evaluation

Array = npt.NDArray[np.float64]

CORNER = np.array([44.0, 18.0])
SIZE = np.array([WIDTH - 60.0, 120.0])
FOOT = 30.0
BAR_SHARE = 0.92
FEWEST_BINS, MOST_BINS = 8, 40
ACROSS_STEPS, UP_STEPS = 5, 3
LEVEL = Pen("ink", 0.9, dash=(3.0, 2.0))
LEVEL_SIZE, LEVEL_GAP = 6.5, 6.0
TITLE_LEFT = 32.0
HEADROOM = 1.08


def histogram(evaluation: Evaluation, ink: Ink) -> Figure:
    """The errors in space of one system, with the levels of its table."""
    sizes_m = SPATIAL.of(evaluation)
    edges_m = _edges_m(sizes_m, reach_of([sizes_m]).end)
    counts, _ = np.histogram(np.minimum(sizes_m, edges_m[-1]), edges_m)
    axes = Axes(np.zeros(2), np.array([edges_m[-1], HEADROOM * counts.max()]), CORNER, SIZE)
    shapes = (*_grid(axes), *_bars(axes, counts, edges_m, ink), *_levels(axes, evaluation))
    drawing = Drawing(WIDTH, float(CORNER[1] + SIZE[1] + FOOT), shapes)
    width = fixed(float(edges_m[1]), digits_of_step(float(edges_m[1])))
    caption = f"Histogram of {count(len(sizes_m))} errors in space, in bins of {width} m.{_beyond(sizes_m, edges_m)}"
    return Figure(drawing, caption, f"{len(counts)} bars, the highest of {count(int(counts.max()))} pairs.")


def _beyond(sizes_m: Array, edges_m: Array) -> str:
    """The sentence for what the axis does not show."""
    outside = int((sizes_m > edges_m[-1]).sum())
    if outside == 0:
        return ""
    return f" The last bar holds {count(outside)} beyond the axis as well, the greatest at {error_m(sizes_m.max())} m."


def _edges_m(sizes_m: Array, end_m: float) -> Array:
    """Bins of Freedman's and Diaconis' width (Z. Wahrscheinlichkeitstheorie 57, 1981), rounded, in sensible number."""
    low_m, high_m = np.quantile(sizes_m, [0.25, 0.75])
    width_m = 2.0 * float(high_m - low_m) / len(sizes_m) ** (1.0 / 3.0)
    round_m = nice_below(min(max(width_m, end_m / MOST_BINS), end_m / FEWEST_BINS))
    return round_m * np.arange(np.ceil(end_m / round_m) + 1.0)


def _grid(axes: Axes) -> list[Shape]:
    across = nice_step(0.0, float(axes.high[0]), ACROSS_STEPS)
    unit = SPATIAL.unit_up_to(float(axes.high[0]))
    up = max(1.0, nice_step(0.0, float(axes.high[1]), UP_STEPS))
    return [
        *replace(axes, written=unit.per_base).grid(0, across, digits_of_step(across * unit.per_base)),
        *axes.grid(1, up, 0),
        *axes.titles(SPATIAL.along(unit), "pairs", TITLE_LEFT),
    ]


def _bars(axes: Axes, counts: npt.NDArray[np.intp], edges_m: Array, ink: Ink) -> list[Shape]:
    shapes: list[Shape] = []
    half_m = 0.5 * BAR_SHARE * float(edges_m[1])
    for middle_m, height in zip((edges_m[1:] + edges_m[:-1]) / 2.0, counts, strict=True):
        if height > 0:
            low = axes.place(np.array([middle_m - half_m, 0.0]))
            high = axes.place(np.array([middle_m + half_m, float(height)]))
            shapes.append(rectangle(low, high, Pen(ink, 0.0, filled=True)))
    shapes.append(rectangle(axes.corner, axes.corner + axes.size, FRAME))
    return shapes


def _levels(axes: Axes, evaluation: Evaluation) -> list[Shape]:
    """SE50 and SE95, each named above the frame, the names beside each other however near the levels are."""
    spatial = evaluation.accuracy.spatial
    levels_m = np.array([spatial.median, spatial.quantile_95])
    foot = axes.place(np.column_stack([levels_m, np.zeros(2)]))
    top = axes.place(np.column_stack([levels_m, np.full(2, axes.high[1])]))
    texts = [f"{name} {error_m(level_m)} m" for name, level_m in zip(("SE50", "SE95"), levels_m.tolist(), strict=True)]
    widths = LETTER_WIDTH * LEVEL_SIZE * np.array([len(text) for text in texts])
    names = [
        Label(np.array([x, axes.corner[1] - 4.0]), text, "ink", LEVEL_SIZE, "middle")
        for x, text in zip(_apart(axes, top[:, 0], widths), texts, strict=True)
    ]
    return [*(line(low, high, LEVEL) for low, high in zip(foot, top, strict=True)), *names]


def _apart(axes: Axes, middles: Array, widths: Array) -> tuple[float, float]:
    """Middles of two texts, moved so that they stand within the frame and not in each other."""
    least, most = axes.corner[0] + widths[0] / 2.0, axes.corner[0] + axes.size[0] - widths[1] / 2.0
    step = widths.sum() / 2.0 + LEVEL_GAP
    second = min(max(middles[1], least + step), most)
    return float(min(max(middles[0], least), second - step)), float(second)
