"""Root mean square residual of each photograph, in the order of the table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.photogrammetry.report import PhotoRecord
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Label, Pen, Shape, line, rectangle
from app.services.reporting.figures.axes import Axes, digits_of_step, nice_step, ticks
from app.services.reporting.numbers import pixels

WIDTH, HEIGHT = 440.0, 150.0
CORNER = np.array([42.0, 8.0])
FOOT = 30.0
BARS = Pen("photo", 0.5, filled=True)
MEDIAN = Pen("error", 1.0)
BAR_SHARE = 0.8
STEPS = 4
NUMBERS = 10


def photo_residuals(photos: Sequence[PhotoRecord]) -> Figure:
    """A bar per photograph, numbered as in the table."""
    rms_px = np.array([photo.rms_px for photo in photos])
    median_px = float(np.median(rms_px))
    size = np.array([WIDTH - CORNER[0] - 8.0, HEIGHT - CORNER[1] - FOOT])
    high_px = 1.08 * float(rms_px.max()) or 1.0
    axes = Axes(np.array([0.5, 0.0]), np.array([len(photos) + 0.5, high_px]), CORNER, size)
    step_px = nice_step(0.0, high_px, STEPS)
    shapes: list[Shape] = [*axes.grid(1, step_px, digits_of_step(step_px)), *_numbers(axes, len(photos))]
    for index, value_px in enumerate(rms_px):
        low = axes.place(np.array([index + 1 - BAR_SHARE / 2, 0.0]))
        shapes.append(rectangle(low, axes.place(np.array([index + 1 + BAR_SHARE / 2, value_px])), BARS))
    ends = axes.place(np.array([[axes.low[0], median_px], [axes.high[0], median_px]]))
    shapes.append(line(ends[0], ends[1], MEDIAN))
    caption = (
        "Root mean square residual of each photograph, px, by its number in the table; the line is the median, "
        f"{pixels(median_px)} px."
    )
    worst = int(rms_px.argmax())
    description = f"{len(photos)} bars; the highest is photograph {worst + 1}, {pixels(float(rms_px[worst]))} px."
    return Figure(Drawing(WIDTH, HEIGHT, tuple(shapes)), caption, description)


def _numbers(axes: Axes, photos: int) -> list[Shape]:
    """Numbers of the photographs below their bars, and what they are."""
    step = max(1.0, nice_step(0.0, float(photos), NUMBERS))
    below = np.array([0.0, 11.0])
    shapes: list[Shape] = [
        Label(axes.place(np.array([number, 0.0])) + below, f"{number:.0f}", "muted", 7.0, "middle")
        for number in ticks(1.0, float(photos), step)
    ]
    middle = axes.corner + np.array([axes.size[0] / 2.0, axes.size[1] + FOOT - 4.0])
    return [*shapes, Label(middle, "photograph", "muted", 7.0, "middle")]
