"""The plate as a linear model: what sixteen blurred dots on black, inside white paper, look like in plate coordinates.

A patch around a plate is a sum of known pictures: each dot's blurred disc and its two derivatives, the background with
a gradient, the paper around the plate. The coefficients, found by one matrix product per plate, give each dot's colour
free of its neighbours' blur, and, as ratio of derivative to disc, where it really stands (one Gauss-Newton step of a
template fit).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cache

import numpy as np
import numpy.typing as npt
from scipy.special import erf, ive

from app.targets.layout import DOT_COUNT, DOT_RADIUS_U, PLATE_SIDE_U
from app.vision.homography import PLATE_DOTS_U
from app.vision.kernels.coefficients import BACKGROUND, COEFFICIENTS, PAPER, PER_DOT
from app.vision.kernels.projection import WINDOW_STEP, whole_steps

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]

PATCH_REACH_U = 6.4  # up to the plate's edge (6.5): beyond it stands whatever the plate was posted on
BLUR_STEP_U = 0.03  # templates are kept at multiples of this blur: half a step changes a dot's amplitude by 1 %
BLUR_LEVELS = (3, 30)

# A dot is looked at as far as its edge and so many standard deviations of blur, where 1e-4 of it is left.
WINDOW_BLURS = 4.0

PAPER_RIDGE = 1e-3  # the paper enters a patch by blur alone; without blur its columns vanish


class PatchGrid(Enum):
    """How densely a patch is sampled: samples per side over the patch's width."""

    ROUGH = 21  # every 0.64 u: three samples across a dot tell its colour and its place to a tenth of its radius
    FINE = 33  # every 0.4 u: five samples across a dot
    DENSE = 49  # every 0.27 u, for large plates

    @property
    def px_per_u_max(self) -> float:
        """Largest plate that the grid does justice to: samples stand 2-2.4 px apart there, and none falls between.

        The rough grid looks at single pixels of any plate.
        """
        return {PatchGrid.ROUGH: np.inf, PatchGrid.FINE: 4.8, PatchGrid.DENSE: 9.0}[self]

    @cache
    def axis_u(self) -> Array:
        """Coordinates, shape (value,), of a patch's columns, and of its rows."""
        return np.linspace(-PATCH_REACH_U, PATCH_REACH_U, self.value)

    @cache
    def points_u(self) -> Array:
        """Plate coordinates, shape (S, 2), of a patch's samples."""
        x, y = np.meshgrid(self.axis_u(), self.axis_u())
        return np.stack([x.ravel(), y.ravel()], axis=1)


@dataclass(frozen=True)
class PlateTemplate:
    """A plate's linear model at one blur, as far as it is not zero.

    Attributes
    ----------
    weights : ndarray of shape (16, 3, W), float32
        Each dot's disc and derivatives in its window, row by row; zeros behind.
    windows : ndarray of shape (16, 3)
        Of each window the first sample, its rows and its columns.
    planes : ndarray of shape (6, S), float32
        The background's and the paper's columns.
    cofactors : ndarray of shape (54, 54)
        The inverse of the normal matrix with the paper's ridge.
    offset_cofactors : ndarray of shape (16, 2, 2)
        Cofactor matrix of each dot's two derivative coefficients.
    normals : ndarray of shape (54, 54)
        The normal matrix of all samples, without a ridge.
    """

    weights: Array32
    windows: npt.NDArray[np.int64]
    planes: Array32
    cofactors: Array
    offset_cofactors: Array
    normals: Array


def blur_level(blur_u: Array) -> npt.NDArray[np.int64]:
    """The template's level nearest to a blur in u."""
    least, most = BLUR_LEVELS
    return np.minimum(np.maximum(np.rint(blur_u / BLUR_STEP_U), least), most).astype(np.int64)


def plate_template(grid: PatchGrid, level: int) -> PlateTemplate:
    """The template for a blur of ``level * BLUR_STEP_U`` (standard deviation, u)."""
    design, windows = plate_design(grid, level), _windows(grid, level)
    weights = np.zeros((DOT_COUNT, PER_DOT, whole_steps(int(windows[0, 1:].prod()))), dtype=np.float32)
    for dot, seen in enumerate(_seen_through(windows, grid)):
        weights[dot, :, : len(seen)] = design[seen, PER_DOT * dot : PER_DOT * (dot + 1)].T
    ridge = PAPER_RIDGE * len(design)
    normals = design.T @ design
    cofactors = np.linalg.inv(normals + np.diag(np.where(np.arange(COEFFICIENTS) < PAPER, 0.0, ridge)))
    first = PER_DOT * np.arange(DOT_COUNT)[:, None, None] + 1
    offset_cofactors = cofactors[first + np.arange(2)[:, None], first + np.arange(2)]
    planes = np.ascontiguousarray(design[:, BACKGROUND:].T, dtype=np.float32)
    return PlateTemplate(weights, windows, planes, cofactors, offset_cofactors, normals)


@dataclass(frozen=True)
class TemplateShelf:
    """The templates of one grid side by side, so that one call of a compiled loop fits plates of any blur.

    Attributes
    ----------
    grid : PatchGrid
    made : ndarray of shape (L,), bool
        Which levels stand on it; a level is made when it is first asked for.
    parts : tuple of ndarray
        The fields of ``PlateTemplate`` by level, in their order; a level's weights one after the other, as many as it
        has. What was never written takes no memory.
    """

    grid: PatchGrid
    made: npt.NDArray[np.bool_]
    parts: tuple[Array32, npt.NDArray[np.int64], Array32, Array, Array, Array]

    @classmethod
    def empty(cls, grid: PatchGrid) -> TemplateShelf:
        """With room for all levels."""
        levels, samples = BLUR_LEVELS[1] + 1, grid.value**2
        rows, columns = _windows(grid, BLUR_LEVELS[1])[0, 1:]
        parts = (
            np.zeros((levels, DOT_COUNT * PER_DOT * whole_steps(int(rows * columns))), dtype=np.float32),
            np.zeros((levels, DOT_COUNT, 3), dtype=np.int64),
            np.zeros((levels, COEFFICIENTS - BACKGROUND, samples), dtype=np.float32),
            np.zeros((levels, COEFFICIENTS, COEFFICIENTS)),
            np.zeros((levels, DOT_COUNT, 2, 2)),
            np.zeros((levels, COEFFICIENTS, COEFFICIENTS)),
        )
        return cls(grid, np.zeros(levels, dtype=np.bool_), parts)

    def put(self, level: int) -> None:
        """Make a level's template."""
        template = plate_template(self.grid, level)
        weights, windows, planes, cofactors, offset_cofactors, normals = self.parts
        weights[level, : template.weights.size] = template.weights.ravel()
        windows[level], planes[level], normals[level] = template.windows, template.planes, template.normals
        cofactors[level], offset_cofactors[level] = template.cofactors, template.offset_cofactors
        self.made[level] = True


@cache
def _shelf_of(grid: PatchGrid) -> TemplateShelf:
    return TemplateShelf.empty(grid)


def shelf_with(grid: PatchGrid, levels: npt.NDArray[np.int64]) -> TemplateShelf:
    """The grid's templates, of which those of some levels are sure to be made."""
    shelf = _shelf_of(grid)
    for level in set(levels[~shelf.made[levels]].tolist()):
        shelf.put(level)
    return shelf


def plate_design(grid: PatchGrid, level: int) -> Array:
    """The model as one matrix, shape (S, 54): takes the coefficients to the samples."""
    blur_u, samples_u = level * BLUR_STEP_U, grid.points_u()
    offset_u = samples_u[:, None] - PLATE_DOTS_U
    radius_u = np.hypot(offset_u[..., 0], offset_u[..., 1])
    disc, by_radius = blurred_disc(radius_u, blur_u)
    # Moving the dot by +d moves the picture the other way: the derivative by the dot's place is -by_radius.
    slope = -by_radius[..., None] * offset_u / np.maximum(radius_u, 1e-9)[..., None]
    dots = np.concatenate([disc[..., None], slope], axis=-1)
    for dot, seen in enumerate(_seen_through(_windows(grid, level), grid)):
        dots[np.setdiff1d(np.arange(len(dots)), seen), dot] = 0.0
    plane = np.column_stack([np.ones(len(samples_u)), samples_u / PATCH_REACH_U])
    return np.hstack([dots.reshape(len(samples_u), -1), plane, plane * _paper(samples_u, blur_u)[:, None]])


def _windows(grid: PatchGrid, level: int) -> npt.NDArray[np.int64]:
    """First sample, rows and columns, shape (16, 3), of each dot's window; all have one size."""
    axis_u = grid.axis_u()
    step_u = axis_u[1] - axis_u[0]
    reach_u = DOT_RADIUS_U + WINDOW_BLURS * level * BLUR_STEP_U
    side = min(int(2.0 * reach_u / step_u) + 1, grid.value)
    size = np.array([-(-side // WINDOW_STEP) * WINDOW_STEP, side])
    nearest = np.rint((PLATE_DOTS_U - axis_u[0]) / step_u - 0.5 * (size - 1))
    column, row = np.clip(nearest, 0, grid.value - size).astype(np.int64).T
    return np.column_stack([row * grid.value + column, np.tile(size[::-1], (DOT_COUNT, 1))])


def _seen_through(windows: npt.NDArray[np.int64], grid: PatchGrid) -> npt.NDArray[np.int64]:
    """The samples of each window, shape (16, rows * columns)."""
    rows, columns = (np.arange(count) for count in windows[0, 1:])
    inside = rows[:, None] * grid.value + columns
    result: npt.NDArray[np.int64] = windows[:, :1] + inside.reshape(1, -1)
    return result


def blurred_disc(radius_u: Array, blur_u: float) -> tuple[Array, Array]:
    """A unit disc under a Gaussian blur, and its derivative by the distance from its centre.

    Notes
    -----
    T(rho) = int_0^1 r / s^2 exp(-(rho^2 + r^2) / 2 s^2) I0(rho r / s^2) dr, the circular convolution in polar
    coordinates; the scaled Bessel function keeps the product finite. Tabulated and interpolated linearly.
    """
    # Beyond six standard deviations from the edge nothing of the disc is left.
    table_u = np.linspace(0.0, DOT_RADIUS_U + 6.0 * blur_u, 301)
    # The kernel is a ridge of width blur_u at r = rho: the quadrature has to resolve it.
    nodes, weights = np.polynomial.legendre.leggauss(64)
    r, weights = 0.5 * DOT_RADIUS_U * (nodes + 1.0), 0.5 * DOT_RADIUS_U * weights
    rho = table_u[:, None]
    argument = rho * r / blur_u**2
    kernel = r / blur_u**2 * np.exp(-((rho - r) ** 2) / (2.0 * blur_u**2))
    disc = (kernel * ive(0, argument)) @ weights
    by_radius = (kernel * (r * ive(1, argument) - rho * ive(0, argument)) / blur_u**2) @ weights
    return np.interp(radius_u, table_u, disc, right=0.0), np.interp(radius_u, table_u, by_radius, right=0.0)


def _paper(samples_u: Array, blur_u: float) -> Array:
    """1 minus the blurred square plate at the samples: how much paper shows through."""
    half, scale = PLATE_SIDE_U / 2.0, np.sqrt(2.0) * blur_u
    inside = 0.5 * (erf((samples_u + half) / scale) - erf((samples_u - half) / scale))
    result: Array = 1.0 - inside[:, 0] * inside[:, 1]
    return result
