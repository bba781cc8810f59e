"""How residuals spread, beside the normal distribution of the same width."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.photogrammetry.image_residuals import ImageResiduals
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Label, Path, Pen, Shape, rectangle
from app.services.reporting.figures.axes import Axes, digits_of_step, nice_step
from app.services.reporting.numbers import count, fixed

Array = npt.NDArray[np.float64]

WIDTH, HEIGHT = 440.0, 150.0
CORNER = np.array([42.0, 8.0])
FOOT = 30.0
BARS = Pen("target", 0.5, filled=True)
CURVE = Pen("error", 1.2)
BAR_SHARE = 0.9
STEPS = 4
CURVE_POINTS = 129


def residual_histogram(found: ImageResiduals) -> Figure:
    """Histogram of all image coordinates' residuals of one camera."""
    total, bins = int(found.histogram.sum()), len(found.histogram)
    reach_px = found.bin_px * bins / 2.0
    curve = _normal(found, total)
    highest = 1.08 * max(float(found.histogram.max()), float(curve[:, 1].max()))
    size = np.array([WIDTH - CORNER[0] - 8.0, HEIGHT - CORNER[1] - FOOT])
    axes = Axes(np.array([-reach_px, 0.0]), np.array([reach_px, highest]), CORNER, size)
    shapes: list[Shape] = [*_grid(axes), *_bars(axes, found), Path(axes.place(curve), CURVE)]
    caption = (
        f"Residuals of {count(total)} image coordinates (bars) and the normal distribution of their root mean square, "
        f"{fixed(found.rms_px, 3)} px (line). The outer bars hold all residuals beyond."
    )
    beyond = int(found.histogram[0] + found.histogram[-1])
    description = (
        f"Histogram between -{fixed(reach_px, 3)} and {fixed(reach_px, 3)} px; {beyond} lie in the outer bars."
    )
    return Figure(Drawing(WIDTH, HEIGHT, tuple(shapes)), caption, description)


def _normal(found: ImageResiduals, total: int) -> Array:
    """Expected count per bin of a normal distribution, shape (N, 2)."""
    x_px = np.linspace(-1.0, 1.0, CURVE_POINTS) * found.bin_px * len(found.histogram) / 2.0
    density = np.exp(-0.5 * (x_px / found.rms_px) ** 2) / (found.rms_px * np.sqrt(2.0 * np.pi))
    return np.stack([x_px, total * found.bin_px * density], axis=-1)


def _grid(axes: Axes) -> list[Shape]:
    across = nice_step(float(axes.low[0]), float(axes.high[0]), 2 * STEPS)
    up = max(1.0, nice_step(0.0, float(axes.high[1]), STEPS))
    middle = axes.corner + np.array([axes.size[0] / 2.0, axes.size[1] + FOOT - 4.0])
    return [
        *axes.grid(1, up, 0),
        *axes.grid(0, across, digits_of_step(across)),
        Label(middle, "residual, px", "muted", 7.0, "middle"),
    ]


def _bars(axes: Axes, found: ImageResiduals) -> list[Shape]:
    bars: list[Shape] = []
    for index, height in enumerate(found.histogram):
        middle_px = (index + 0.5 - len(found.histogram) / 2.0) * found.bin_px
        half_px = 0.5 * BAR_SHARE * found.bin_px
        low = axes.place(np.array([middle_px - half_px, 0.0]))
        bars.append(rectangle(low, axes.place(np.array([middle_px + half_px, float(height)])), BARS))
    return bars
