"""Mean residuals over the image: arrows that show what the camera's model leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.image_residuals import ImageResiduals
from app.photogrammetry.report import CameraRecord
from app.services.reporting.document import Figure
from app.services.reporting.drawing import Drawing, Ellipse, Label, Pen, Shape, arrow, line, rectangle
from app.services.reporting.figures.axes import Axes
from app.services.reporting.numbers import count, fixed, nice_below

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class FieldOptions:
    """How the field is drawn.

    Attributes
    ----------
    side : float
        Longer side of the image on the sheet, points.
    fewest_dots : int
        Dots below which a cell shows no arrow: the dots of a plate err together, so two plates at least.
    arrow : float
        Length of a long arrow (95 of 100 are shorter), in cells.
    """

    side: float = 400.0
    fewest_dots: int = 32
    arrow: float = 0.9


LONG_PERCENTILE = 95.0
FOOT = 24.0
MARGIN = np.array([1.0, 1.0])
FRAME = Pen("muted", 0.8)
ARROW = Pen("error", 0.9)
EMPTY = Pen("grid", 0.0, filled=True)
EMPTY_RADIUS = 1.0


def residual_field(camera: CameraRecord, found: ImageResiduals, options: FieldOptions = FieldOptions()) -> Figure:
    """Mean residuals of one camera's photographs in the cells of its image."""
    size_px = np.array([camera.width_px, camera.height_px], dtype=np.float64)
    axes = Axes(
        np.array([0.0, size_px[1]]), np.array([size_px[0], 0.0]), MARGIN, size_px / size_px.max() * options.side
    )
    lengths_px = np.hypot(*np.moveaxis(found.mean_px, -1, 0))
    shown = found.counts >= options.fewest_dots
    longest_px = float(np.percentile(lengths_px[shown], LONG_PERCENTILE)) if shown.any() else 0.0
    points_per_px = float(axes.points_per_unit[0])
    enlargement = nice_below(options.arrow * found.cell_px / longest_px) if longest_px > 0 else 1.0
    shapes: list[Shape] = [rectangle(MARGIN, MARGIN + axes.size, FRAME)]
    for (row, column), arrows in np.ndenumerate(shown):
        centre = axes.place(_middle_px(np.array([column, row]), found.cell_px, size_px))
        if arrows:
            shapes.extend(arrow(centre, found.mean_px[row, column] * enlargement * points_per_px, ARROW))
        else:
            shapes.append(Ellipse(centre, np.full(2, EMPTY_RADIUS), 0.0, EMPTY))
    shapes.extend(_bar(axes, enlargement, longest_px))
    drawing = Drawing(float(axes.size[0] + 2 * MARGIN[0]), float(axes.size[1]) + FOOT, tuple(shapes))
    description = f"{int(shown.sum())} arrows over the image, 95 of 100 shorter than {fixed(longest_px, 3)} px."
    return Figure(drawing, _caption(camera, found, enlargement, options.fewest_dots), description)


def _caption(camera: CameraRecord, found: ImageResiduals, enlargement: float, fewest_dots: int) -> str:
    return (
        f"Mean residuals (computed minus observed) over the image of {camera.width_px} x {camera.height_px} px, in "
        f"cells of {fixed(found.cell_px, 0)} px, enlarged {count(round(enlargement))} times. Cells with fewer than "
        f"{fewest_dots} of the {count(int(found.counts.sum()))} dots show a point. Arrows that follow a pattern would "
        "mean distortion that the camera's model lacks."
    )


def _middle_px(cell: Array, cell_px: float, size_px: Array) -> Array:
    """The middle of what the image has of a cell (column, row): the last ones may reach beyond it."""
    return np.asarray((cell_px * cell + np.minimum(cell_px * (cell + 1), size_px)) / 2.0)


def _bar(axes: Axes, enlargement: float, longest_px: float) -> list[Shape]:
    """How long an arrow of a round length is."""
    if longest_px == 0.0:
        return []
    length_px = nice_below(longest_px)
    start = axes.corner + np.array([0.0, axes.size[1] + 14.0])
    end = start + np.array([length_px * enlargement * axes.points_per_unit[0], 0.0])
    tick = np.array([0.0, 3.0])
    label = Label(end + np.array([6.0, 2.5]), f"{length_px:g} px", "error", 7.0)
    return [
        line(start, end, ARROW),
        line(start - tick, start + tick, ARROW),
        line(end - tick, end + tick, ARROW),
        label,
    ]
