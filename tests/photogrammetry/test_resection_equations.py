"""The linearised collinearity equations against differences, and the elimination against the dense system."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.geometry.camera import CalibratedCamera
from app.geometry.plate_sigmas import PlateSigmas
from app.photogrammetry.plate_correlation import plate_basis
from app.photogrammetry.resection_equations import CameraPrior, State, linearise, residuals_of
from app.photogrammetry.resection_input import SightedTargets, sight_targets
from tests.photogrammetry.resection_scene import calibrated, displaced, observe, room_scene

Array = npt.NDArray[np.float64]

COUNT = 4


def sighted(seed: int = 0, own: float = 1.0) -> tuple[SightedTargets, State]:
    """Noisy observations, one target partly hidden, and a state beside the truth."""
    scene = room_scene(COUNT, seed)
    rng = np.random.default_rng(seed)
    observations = observe(scene, rng)
    hidden = observations[0].measured.copy()
    hidden[[1, 4, 7, 15]] = False
    observations[0] = replace(observations[0], measured=hidden)
    observations[1] = replace(observations[1], plate_sigmas=PlateSigmas(1.6, 1.3, 0.8))
    observations[2] = replace(observations[2], plate_sigmas=PlateSigmas(2.0, 0.7, 1.0), measured=hidden)
    targets = [replace(target, covariance=own * target.covariance) for target in scene.target_map.targets]
    state = State(scene.site_from_cam.moved(rng.normal(0, 1e-3, 6)), rng.normal(0, 0.5, 9))
    return sight_targets(observations, scene.with_targets(targets).target_map), state


def whitened_residuals(seen: SightedTargets, prior: CameraPrior, state: State, own: Array | None = None) -> Array:
    """Residuals (K, 32) in units of the dots' covariance, after moving each target by its own six, shape (K, 6)."""
    dots_m = seen.dots_m.copy()
    for k in range(len(seen)):
        if own is not None:
            turned = np.cross(own[k, 3:], seen.arms_m[k])
            dots_m[k] += own[k, :3] + turned
    cam_m = state.site_from_cam.inverse().apply(dots_m)
    residuals_px = prior.camera_at(state.whitened).project(cam_m) - seen.observed_px
    whiteners = np.zeros((*seen.measured.shape, 2, 2))
    whiteners[..., 0, 0], whiteners[..., 1, 0], whiteners[..., 1, 1] = np.moveaxis(seen.whiteners, -1, 0)
    return (whiteners @ residuals_px[..., None]).reshape(len(seen), -1)


def shared_covariance(seen: SightedTargets, k: int) -> Array:
    """Of a target's whitened coordinates, shape (32, 32), with the errors that its dots share."""
    whiteners = np.zeros((16, 2, 2))
    whiteners[:, 0, 0], whiteners[:, 1, 0], whiteners[:, 1, 1] = seen.whiteners[k].T
    basis = plate_basis(whiteners[None])[0]
    shift, linear, dots = seen.plate_sigmas[k]
    of_modes = np.array([shift] * 2 + [linear] * 4)
    return dots**2 * np.eye(32) + basis * (of_modes**2 - dots**2) @ basis.T


def numerical_design(seen: SightedTargets, prior: CameraPrior, state: State) -> tuple[Array, Array]:
    """Central differences of the whitened residuals by the state (K, 32, 15) and by own movements (K, 32, 6)."""
    steps = np.array([1e-6] * 6 + [0.03] * 9)  # m, rad, standard deviations of the camera

    def at(state: State, own: Array | None = None) -> Array:
        return whitened_residuals(seen, prior, state, None if own is None else np.tile(own, (len(seen), 1)))

    by_state = [at(state.moved(step)) - at(state.moved(-step)) for step in np.diag(steps)]
    by_own = [at(state, step) - at(state, -step) for step in steps[0] * np.eye(6)]
    return np.stack(by_state, axis=-1) / (2 * steps), np.stack(by_own, axis=-1) / (2 * steps[0])


@given(seed=st.integers(0, 10_000))
@settings(max_examples=10, deadline=None)
def test_equations_are_those_of_the_dense_system_from_central_differences(seed: int) -> None:
    seen, state = sighted(seed)
    prior = CameraPrior.of(calibrated(5.0))
    equations = linearise(seen, prior, state)
    by_state, by_own = numerical_design(seen, prior, state)
    residuals = whitened_residuals(seen, prior, state)
    for k in range(len(seen)):
        covariance = shared_covariance(seen, k) + by_own[k] @ seen.own_covariances[k] @ by_own[k].T
        weighted = np.linalg.solve(covariance, np.column_stack([by_state[k], residuals[k]]))
        expected = by_state[k].T @ weighted[:, :-1]
        # Central differences are good to 1e-7 relative here, by step and by rounding; their products to twice that.
        scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
        np.testing.assert_array_less(np.abs(equations.information[k] - expected) / scale, 1e-6)
        limit = 1e-6 * np.sqrt(np.diag(expected) * (residuals[k] @ residuals[k]))
        assert (np.abs(equations.gradient[k] - by_state[k].T @ weighted[:, -1]) < limit).all()
        assert equations.chi2[k] == pytest.approx(residuals[k] @ weighted[:, -1], rel=1e-6)


def test_a_perfect_map_needs_no_inverse() -> None:
    seen, state = sighted(own=0.0)
    prior = CameraPrior.of(calibrated())
    residuals = whitened_residuals(seen, prior, state)
    expected = [r @ np.linalg.solve(shared_covariance(seen, k), r) for k, r in enumerate(residuals)]
    np.testing.assert_allclose(linearise(seen, prior, state).chi2, expected)


def test_hidden_dots_have_no_say() -> None:
    seen, state = sighted()
    prior = CameraPrior.of(calibrated())
    moved_px = np.where(seen.measured[..., None], seen.observed_px, 1e6)
    one, other = linearise(seen, prior, state), linearise(replace(seen, observed_px=moved_px), prior, state)
    np.testing.assert_array_equal(one.information, other.information)
    np.testing.assert_array_equal(one.chi2, other.chi2)
    assert (residuals_of(seen, prior, state)[~seen.measured] == 0).all()


def test_shape_chi2_is_blind_to_rigid_movements_and_only_to_those() -> None:
    scene = room_scene(COUNT, 3)
    prior, state = CameraPrior.of(calibrated()), State(scene.site_from_cam, np.zeros(9))
    targets = list(scene.target_map.targets)
    targets[0] = displaced(targets[0], np.array([1e-4, -1e-4, 5e-5]), np.array([1e-3, 0.0, -1e-3]))
    bent_m = targets[1].dots_m.copy()
    bent_m[5] += 2e-3 * targets[1].site_from_target.rotation[:, 0]
    targets[1] = replace(targets[1], dots_m=bent_m)
    seen = sight_targets(observe(scene), scene.with_targets(targets).target_map)
    equations = linearise(seen, prior, state)
    assert equations.chi2[0] > 0.5
    # The movement is rigid to first order: 1e-3 rad squared over the plate's 0.09 m is 1e-7 m, a thousandth of a sigma.
    assert equations.shape_chi2[0] < 1e-4
    assert equations.shape_chi2[1] > 10.0


def test_shape_chi2_of_few_dots_is_zero_when_they_fix_no_more_than_the_movement() -> None:
    scene = room_scene(2, 1)
    observations = observe(scene, np.random.default_rng(0))
    three = np.isin(np.arange(16), [0, 3, 12])
    observations[0] = replace(observations[0], measured=three)
    seen = sight_targets(observations, scene.target_map)
    equations = linearise(seen, CameraPrior.of(calibrated()), State(scene.site_from_cam, np.zeros(9)))
    assert equations.shape_chi2[0] < 1e-3
    assert equations.shape_chi2[1] > 1.0


def test_targets_behind_the_camera_or_seen_from_the_back_are_marked() -> None:
    scene = room_scene(3, 2)
    target = scene.target_map.targets[0]
    back = displaced(target, np.zeros(3), np.pi * target.site_from_target.rotation[:, 1])
    behind = displaced(scene.target_map.targets[1], np.array([0.0, -12.0, 0.0]), np.zeros(3))
    turned = scene.with_targets([back, behind, scene.target_map.targets[2]])
    seen = sight_targets(observe(scene), turned.target_map)
    equations = linearise(seen, CameraPrior.of(calibrated()), State(scene.site_from_cam, np.zeros(9)))
    assert equations.seen_from_front.tolist() == [False, False, True]
    assert np.isfinite(equations.information).all()


def test_camera_prior_reproduces_its_covariance_and_mean() -> None:
    calibration = calibrated()
    prior = CameraPrior.of(calibration)
    np.testing.assert_allclose(prior.root @ prior.root.T, calibration.covariance, rtol=1e-9, atol=1e-18)
    np.testing.assert_array_equal(prior.camera_at(np.zeros(9)).intrinsics, calibration.camera.intrinsics)


def test_a_covariance_that_is_none_is_refused() -> None:
    covariance = calibrated().covariance.copy()
    covariance[0, 1] = covariance[1, 0] = 2.0 * covariance[0, 0]
    with pytest.raises(ValueError, match="semidefinite"):
        CameraPrior.of(CalibratedCamera(calibrated().camera, covariance, "survey"))


def test_dots_without_a_covariance_are_refused() -> None:
    scene = room_scene(1)
    observations = observe(scene)
    broken = replace(observations[0], covariances_px2=np.zeros((16, 2, 2)))
    with pytest.raises(ValueError, match="positive definite"):
        sight_targets([broken], scene.target_map)
