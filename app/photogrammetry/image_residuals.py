"""Where in the image residuals point, and how they spread: what an unmodelled lens or a bad print shows first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.collinearity import whitened_residuals
from app.photogrammetry.network import Network

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]

PIXEL_EDGE_PX = 0.5  # pixel (0, 0) reaches half a pixel to either side of its centre


@dataclass(frozen=True)
class ResidualPlotOptions:
    """How residuals are gathered for a reader.

    Attributes
    ----------
    dots_per_cell : float
        Dots that a cell should hold on average: the noise of their mean is a tenth of a dot's, or more of what the dots
        of a plate share.
    fewest_cells, most_cells : int
        Square cells along the image's longer side, at least to tell middle and corners apart, at most as many as a
        reader can take in.
    bins : int
        Of the histogram.
    bin_sigmas : float
        Width of a bin in root mean squares: 32 bins of a quarter reach from -4 to 4.
    """

    dots_per_cell: float = 100.0
    fewest_cells: int = 4
    most_cells: int = 16
    bins: int = 32
    bin_sigmas: float = 0.25


@dataclass(frozen=True)
class ImageResiduals:
    """Residuals (computed minus observed) of one camera's photographs.

    Attributes
    ----------
    cell_px : float
        Side of a square cell; the first one begins at the image's top left corner.
    counts : ndarray of shape (rows, columns), int
        Dots in each cell.
    mean_px : ndarray of shape (rows, columns, 2)
        Mean residual of a cell's dots, weighted as the adjustment weighted them; zero where there are none.
    rms_px : float
        Root mean square of all coordinates.
    bin_px : float
        Width of a bin; zero lies between the two middle ones.
    histogram : ndarray of shape (bins,), int
        Coordinates in each bin; the outer ones hold all beyond.
    """

    cell_px: float
    counts: Index
    mean_px: Array
    rms_px: float
    bin_px: float
    histogram: Index


def image_residuals(
    problem: BundleProblem, network: Network, weights: Array, options: ResidualPlotOptions = ResidualPlotOptions()
) -> tuple[ImageResiduals, ...]:
    """Residuals over the image, one record per camera.

    Parameters
    ----------
    problem : BundleProblem
    network : Network
        Adjusted.
    weights : ndarray of shape (M, 16)
        Share of its weight that the robust loss left each dot.
    options : ResidualPlotOptions
    """
    residuals_px = np.zeros(problem.sightings.dots_px.shape)
    camera = np.empty(len(problem.sightings), dtype=np.intp)
    for index, chunk in problem.chunks():
        part = problem.sightings.select(chunk).in_pixels()
        residuals_px[chunk] = whitened_residuals(network, part, problem.camera_at(network, index), problem.plane_m)
        camera[chunk] = index
    measured = problem.sightings.measured
    found = []
    for index, known in enumerate(problem.cameras):
        own = measured & (camera == index)[:, None]
        size_px = known.camera.width_px, known.camera.height_px
        seen = problem.sightings.dots_px[own], residuals_px[own], weights[own]
        found.append(_of_camera(*seen, size_px, options))
    return tuple(found)


def _of_camera(
    dots_px: Array, residuals_px: Array, weights: Array, size_px: tuple[int, int], options: ResidualPlotOptions
) -> ImageResiduals:
    """Cells and histogram of N dots (N, 2)."""
    cell_px = _cell_px(len(dots_px), size_px, options)
    columns, rows = (int(np.ceil(side / cell_px)) for side in size_px)
    place = np.floor((dots_px + PIXEL_EDGE_PX) / cell_px).astype(np.intp)
    cell = place[:, 1].clip(0, rows - 1) * columns + place[:, 0].clip(0, columns - 1)
    total = np.bincount(cell, weights, rows * columns)
    sums = [np.bincount(cell, weights * residuals_px[:, axis], rows * columns) for axis in (0, 1)]
    mean_px = np.stack([np.divide(one, total, out=np.zeros_like(one), where=total > 0) for one in sums], axis=-1)
    rms_px = float(np.sqrt((residuals_px**2).mean())) if len(residuals_px) else 0.0
    bin_px = options.bin_sigmas * rms_px
    return ImageResiduals(
        cell_px,
        np.bincount(cell, minlength=rows * columns).reshape(rows, columns),
        mean_px.reshape(rows, columns, 2),
        rms_px,
        bin_px,
        _histogram(residuals_px, bin_px, options.bins),
    )


def _cell_px(dots: int, size_px: tuple[int, int], options: ResidualPlotOptions) -> float:
    """Side of a cell that holds as many dots as are wanted on average."""
    wanted = np.sqrt(dots / options.dots_per_cell * max(size_px) / min(size_px))
    return max(size_px) / int(np.clip(wanted, options.fewest_cells, options.most_cells))


def _histogram(residuals_px: Array, bin_px: float, bins: int) -> Index:
    """How many coordinates lie in each bin; exact observations all lie in the middle."""
    bin_of = np.floor(residuals_px.ravel() / bin_px) if bin_px > 0 else np.zeros(residuals_px.size)
    return np.bincount((bin_of + bins // 2).clip(0, bins - 1).astype(np.intp), minlength=bins)
