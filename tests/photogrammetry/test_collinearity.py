"""Collinearity equations: residuals by hand, every derivative against central differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from app.geometry.camera import INTRINSIC_COUNT
from app.geometry.plate_sigmas import PlateSigmas
from app.photogrammetry.collinearity import CAMERA_COLUMNS, PRINT_COLUMNS, linearise, whitened_residuals
from app.photogrammetry.network import POSE_COUNT, Network, NetworkStep
from app.photogrammetry.sightings import Sightings
from app.targets.layout import dot_centres_u
from tests.photogrammetry.survey_scene import CAMERA, U_M
from tests.photogrammetry.true_network import small_truth

Array = npt.NDArray[np.float64]
PLANE_M = dot_centres_u() * U_M
# Steps of m, rad, px; a central difference errs by the third derivative times the square of the step.
STEP = 1e-6


@pytest.fixture(scope="module")
def scene() -> tuple[Network, Sightings]:
    truth = small_truth()
    return truth.network, truth.sightings


@pytest.fixture(params=[None, PlateSigmas(1.6, 1.3, 0.8)], ids=["independent", "correlated"])
def sightings(scene: tuple[Network, Sightings], request: pytest.FixtureRequest) -> Sightings:
    return scene[1] if request.param is None else scene[1].correlated(request.param)


def no_step(network: Network) -> NetworkStep:
    photos, targets = len(network.photo_rotations), len(network.target_rotations)
    return NetworkStep(
        np.zeros((photos, 6)), np.zeros((targets, 6)), np.zeros((1, INTRINSIC_COUNT)), np.zeros((targets, 2))
    )


def difference(network: Network, sightings: Sightings, step: NetworkStep, size: float) -> Array:
    """Central difference of the residuals along a step of some size."""

    def residuals(sign: float) -> Array:
        scaled = NetworkStep(sign * step.photos, sign * step.targets, sign * step.intrinsics, sign * step.print_scale)
        moved = network.moved(scaled)
        camera = CAMERA.with_intrinsics(moved.intrinsics[0])
        return whitened_residuals(moved, sightings, camera, PLANE_M)

    return (residuals(1.0) - residuals(-1.0)) / (2.0 * size)


def test_residuals_of_the_truth_are_zero(scene: tuple[Network, Sightings]) -> None:
    assert np.abs(whitened_residuals(*scene, CAMERA, PLANE_M)).max() < 1e-6


def test_a_residual_is_computed_minus_observed_in_standard_deviations(scene: tuple[Network, Sightings]) -> None:
    network, sightings = scene
    moved = replace(sightings, dots_px=sightings.dots_px - [0.3, -0.7])
    residuals = whitened_residuals(network, moved, CAMERA, PLANE_M)[sightings.measured]
    np.testing.assert_allclose(residuals, np.tile([3.0, -7.0], (len(residuals), 1)), atol=1e-6)  # sigma 0.1 px


def test_linearised_residuals_are_the_residuals(scene: tuple[Network, Sightings], sightings: Sightings) -> None:
    network = scene[0].moved(
        replace(no_step(scene[0]), print_scale=np.tile([0.01, -0.02], (len(scene[0].target_rotations), 1)))
    )
    rows = linearise(network, sightings, CAMERA, PLANE_M)
    np.testing.assert_allclose(rows.residuals, whitened_residuals(network, sightings, CAMERA, PLANE_M), atol=1e-9)


@pytest.mark.parametrize("column", range(POSE_COUNT))
def test_derivative_by_the_target(scene: tuple[Network, Sightings], sightings: Sightings, column: int) -> None:
    step = no_step(scene[0])
    step.targets[:, column] = STEP
    expected = difference(scene[0], sightings, step, STEP)
    jacobian = linearise(scene[0], sightings, CAMERA, PLANE_M).jacobian[..., column]
    np.testing.assert_allclose(jacobian, expected, rtol=1e-5, atol=1e-3)


@pytest.mark.parametrize("column", range(POSE_COUNT))
def test_derivative_by_the_photograph(scene: tuple[Network, Sightings], sightings: Sightings, column: int) -> None:
    step = no_step(scene[0])
    step.photos[:, column] = STEP
    expected = difference(scene[0], sightings, step, STEP)
    equations = linearise(scene[0], sightings, CAMERA, PLANE_M)
    by_photo = equations.jacobian[..., :POSE_COUNT] @ equations.target_step_from_photo_step[:, None]
    np.testing.assert_allclose(by_photo[..., column], expected, rtol=1e-5, atol=1e-3)


@pytest.mark.parametrize("column", range(2))
def test_derivative_by_the_print_scale(scene: tuple[Network, Sightings], sightings: Sightings, column: int) -> None:
    step = no_step(scene[0])
    step.print_scale[:, column] = STEP
    expected = difference(scene[0], sightings, step, STEP)
    jacobian = linearise(scene[0], sightings, CAMERA, PLANE_M).jacobian[..., PRINT_COLUMNS][..., column]
    np.testing.assert_allclose(jacobian, expected, rtol=1e-5, atol=1e-3)


@pytest.mark.parametrize("column", range(INTRINSIC_COUNT))
def test_derivative_by_the_intrinsics(scene: tuple[Network, Sightings], sightings: Sightings, column: int) -> None:
    size = 1e-2 if column < 4 else STEP  # px, or the distortion's own unit
    step = no_step(scene[0])
    step.intrinsics[0, column] = size
    expected = difference(scene[0], sightings, step, size)
    jacobian = linearise(scene[0], sightings, CAMERA, PLANE_M).jacobian[..., CAMERA_COLUMNS][..., column]
    np.testing.assert_allclose(jacobian, expected, rtol=1e-5, atol=1e-3)


def test_a_target_behind_the_camera_has_a_residual_and_pulls_at_nothing(scene: tuple[Network, Sightings]) -> None:
    network, sightings = scene
    first = sightings.select(np.arange(len(sightings)) == 0)
    photo, target = first.photo[0], first.target[0]
    behind = network.photo_positions_m[photo] - network.photo_rotations[photo][:, 2]
    positions_m = network.target_positions_m.copy()
    positions_m[target] = behind
    rows = linearise(replace(network, target_positions_m=positions_m), first, CAMERA, PLANE_M)
    assert np.isfinite(rows.rows).all()
    assert not rows.jacobian.any()
    assert np.abs(rows.residuals[first.measured]).max() > 1e3
