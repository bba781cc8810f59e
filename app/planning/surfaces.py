"""What a panel shows: one colour, a picture, or a printed plate; all in linear light.

A surface is asked for its colour at points of its panel (metres, origin in the middle, x right, y up) and is told how
far apart the samples stand, so that it can soften what is finer than that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
import numpy.typing as npt

from app.planning.tone import linear_of_srgb
from app.targets.drawing import BLACK_RGB, PAPER_RGB, cell_colours_rgb
from app.targets.layout import CELLS_PER_SIDE, DOT_COUNT, DOT_PITCH_U, DOT_RADIUS_U, PLATE_SIDE_U

Floats = npt.NDArray[np.float64]

PAPER_ALBEDO = 0.85  # office paper reflects 80 ... 90 % of the light
FIRST_DOT_U = -1.5 * DOT_PITCH_U  # of the dots' grid, about the plate's centre


@dataclass(frozen=True)
class Samples:
    """Points of a panel where a picture element looks.

    Attributes
    ----------
    x_m, y_m : ndarray of shape (H, W)
        In the panel's frame.
    by_step_m : ndarray of shape (H, W, 2, 2)
        How (x, y) changes from one sample to the next, along the image's columns and rows.
    """

    x_m: Floats
    y_m: Floats
    by_step_m: Floats


class Surface(Protocol):
    """Anything a panel can show."""

    @property
    def detail_m(self) -> float | None:
        """Size of what must be drawn exactly; None when nothing is measured on it."""
        ...

    def albedo(self, samples: Samples) -> Floats:
        """Share of the light that returns, shape (H, W, 3), RGB, linear."""
        ...


@dataclass(frozen=True)
class PlainSurface:
    """One colour, given in sRGB."""

    rgb: tuple[int, int, int]

    @property
    def detail_m(self) -> float | None:
        """Nothing is measured on it."""
        return None

    def albedo(self, samples: Samples) -> Floats:
        """Share of the light that returns, shape (H, W, 3)."""
        return np.broadcast_to(linear_of_srgb(self.rgb), (*samples.x_m.shape, 3))


@dataclass(frozen=True)
class PictureSurface:
    """A picture stretched over the whole panel.

    Attributes
    ----------
    linear_rgb : ndarray of shape (H, W, 3), float32
        Row 0 on top.
    width_m, height_m : float
        The panel's size.
    """

    linear_rgb: npt.NDArray[np.float32]
    width_m: float
    height_m: float

    @property
    def detail_m(self) -> float | None:
        """Nothing is measured on it."""
        return None

    def albedo(self, samples: Samples) -> Floats:
        """Share of the light that returns, shape (H, W, 3), bilinear between the picture's pixels."""
        height_px, width_px = self.linear_rgb.shape[:2]
        column = (samples.x_m / self.width_m + 0.5) * width_px - 0.5
        row = (0.5 - samples.y_m / self.height_m) * height_px - 0.5
        columns, rows = column.astype(np.float32), row.astype(np.float32)
        picture = cv2.remap(self.linear_rgb, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(picture, dtype=np.float64)


@dataclass(frozen=True)
class PlateSurface:
    """A printed plate on its paper.

    Attributes
    ----------
    cells_rgb : ndarray of shape (16, 3), uint8
        Colours of the dots, sRGB, row-major cells.
    u_m : float
        Nominal module.
    print_scale_xy : tuple of float
        Printed over nominal length along and across the plate.
    """

    cells_rgb: npt.NDArray[np.uint8]
    u_m: float
    print_scale_xy: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        if self.cells_rgb.shape != (DOT_COUNT, 3):
            raise ValueError("a plate shows sixteen colours")

    @classmethod
    def of_code(cls, code: int, u_m: float) -> PlateSurface:
        """The plate that says this code."""
        return cls(cell_colours_rgb(code), u_m)

    @property
    def detail_m(self) -> float | None:
        """A dot's radius."""
        return self.u_m * DOT_RADIUS_U

    def albedo(self, samples: Samples) -> Floats:
        """Share of the light that returns, shape (H, W, 3); edges softened over one sample."""
        module_m = np.array(self.print_scale_xy) * self.u_m
        x_u, y_u = samples.x_m / module_m[0], samples.y_m / module_m[1]
        by_step_u = samples.by_step_m / module_m[:, None]
        column, row = _nearest_cell(x_u), _nearest_cell(-y_u)
        dx_u = x_u - (FIRST_DOT_U + DOT_PITCH_U * column)
        dy_u = y_u + (FIRST_DOT_U + DOT_PITCH_U * row)
        inks = PAPER_ALBEDO * linear_of_srgb(np.vstack([self.cells_rgb, BLACK_RGB, PAPER_RGB]))
        dot, black, paper = inks[CELLS_PER_SIDE * row + column], inks[DOT_COUNT], inks[DOT_COUNT + 1]
        in_dot = _dot_coverage(dx_u, dy_u, by_step_u)[..., None]
        in_plate = box_coverage(x_u, y_u, (PLATE_SIDE_U, PLATE_SIDE_U), by_step_u)[..., None]
        return np.asarray(paper + in_plate * (black - paper + in_dot * (dot - black)))


def box_coverage(x: Floats, y: Floats, size: tuple[float, float], by_step: Floats, reach: float = 0.0) -> Floats:
    """Share of each sample, 0 ... 1, inside the rectangle of that size about the origin; edges one sample wide.

    ``reach`` moves the edges outwards, in samples.
    """
    along = (size[0] / 2 - np.abs(x)) / np.hypot(by_step[..., 0, 0], by_step[..., 0, 1])
    across = (size[1] / 2 - np.abs(y)) / np.hypot(by_step[..., 1, 0], by_step[..., 1, 1])
    return np.asarray(np.clip(along + reach + 0.5, 0.0, 1.0) * np.clip(across + reach + 0.5, 0.0, 1.0))


def _nearest_cell(coordinate_u: Floats) -> npt.NDArray[np.int64]:
    cell = np.rint((coordinate_u - FIRST_DOT_U) / DOT_PITCH_U).astype(np.int64)
    return np.clip(cell, 0, CELLS_PER_SIDE - 1)


def _dot_coverage(dx_u: Floats, dy_u: Floats, by_step_u: Floats) -> Floats:
    """Share of each sample inside the dot about whose centre (dx, dy) is given."""
    # In a dot's very middle no direction leads outwards: any step does, for the sample lies inside.
    least = np.finfo(np.float64).tiny
    radius_u = np.maximum(np.hypot(dx_u, dy_u), least)
    out_x, out_y = dx_u / radius_u, dy_u / radius_u
    by_column = out_x * by_step_u[..., 0, 0] + out_y * by_step_u[..., 1, 0]
    by_row = out_x * by_step_u[..., 0, 1] + out_y * by_step_u[..., 1, 1]
    return np.clip((DOT_RADIUS_U - radius_u) / np.maximum(np.hypot(by_column, by_row), least) + 0.5, 0.0, 1.0)
