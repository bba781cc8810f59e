"""Residuals over the image: known errors come back where they were put."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from app.photogrammetry.image_residuals import ImageResiduals, ResidualPlotOptions, image_residuals
from app.photogrammetry.network import Network
from tests.photogrammetry.survey_scene import CAMERA, NOISE_PX, build_room, ring_of_stations
from tests.photogrammetry.true_network import Truth, see

Array = npt.NDArray[np.float64]

CX = 2  # of the intrinsics


@pytest.fixture(scope="module")
def exact() -> Truth:
    return see(build_room(), ring_of_stations(12))


def found_in(truth: Truth, network: Network, weights: Array | None = None) -> ImageResiduals:
    problem = truth.problem
    (found,) = image_residuals(
        problem, network, np.ones(problem.sightings.measured.shape) if weights is None else weights
    )
    return found


def test_a_shifted_principal_point_shows_in_every_cell(exact: Truth) -> None:
    intrinsics = exact.network.intrinsics.copy()
    intrinsics[0, CX] += 0.25
    found = found_in(exact, replace(exact.network, intrinsics=intrinsics))
    seen = found.counts > 0
    np.testing.assert_allclose(found.mean_px[seen], np.tile([0.25, 0.0], (seen.sum(), 1)), atol=1e-9)
    assert not found.mean_px[~seen].any()
    assert found.rms_px == pytest.approx(0.25 / np.sqrt(2.0))


def test_dots_are_counted_where_they_lie(exact: Truth) -> None:
    found = found_in(exact, exact.network)
    rows, cells = found.counts.shape
    assert found.cell_px == pytest.approx(CAMERA.width_px / cells)
    assert rows == int(np.ceil(CAMERA.height_px / found.cell_px))
    measured = exact.problem.sightings.measured
    assert found.counts.sum() == measured.sum()
    left = exact.problem.sightings.dots_px[measured][:, 0] + 0.5 < found.cell_px * (cells // 2)
    assert found.counts[:, : cells // 2].sum() == left.sum()


def test_few_dots_get_large_cells(exact: Truth) -> None:
    sightings = exact.problem.sightings.select(slice(0, 30))
    found = found_in(replace(exact, sightings=sightings), exact.network)
    mean = sightings.measured.sum() / found.counts.size
    options = ResidualPlotOptions()
    assert found.counts.shape[1] >= options.fewest_cells
    assert mean >= options.dots_per_cell / 2 or found.counts.shape[1] == options.fewest_cells


def test_dots_without_weight_do_not_move_the_mean(exact: Truth) -> None:
    sightings = exact.problem.sightings
    dots_px = sightings.dots_px.copy()
    dots_px[::3] += 50.0
    spoilt = replace(exact, sightings=replace(sightings, dots_px=dots_px))
    weights = np.ones(sightings.measured.shape)
    weights[::3] = 0.0
    assert np.abs(found_in(spoilt, exact.network, weights).mean_px).max() < 1e-9


def test_noise_fills_the_histogram_as_a_normal_distribution_does() -> None:
    noisy = see(build_room(), ring_of_stations(12), noise_px=NOISE_PX)
    found = found_in(noisy, noisy.network)
    total = found.histogram.sum()
    assert total == 2 * noisy.problem.sightings.measured.sum()
    assert found.rms_px == pytest.approx(NOISE_PX, rel=5 / np.sqrt(2 * total))
    middle = len(found.histogram) // 2
    within = found.histogram[middle - 4 : middle + 4].sum() / total  # four bins of a quarter: one sigma
    assert within == pytest.approx(0.6827, abs=5 * np.sqrt(0.6827 * 0.3173 / total))
