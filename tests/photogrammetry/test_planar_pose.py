"""Planar poses: exact on exact dots, two of them, mirrored about the line of sight, and honest about what is absent."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.geometry.rotation import angle_between_deg, exp_rotation
from app.photogrammetry.kernels.planar import solve_planar_pose
from app.photogrammetry.planar_pose import PlanarPoseOptions, planar_poses
from app.targets.layout import DEFAULT_U_M, DOT_COUNT, dot_centres_u, dots_target_m

Array = npt.NDArray[np.float64]

PLANE_M = dot_centres_u() * DEFAULT_U_M
FACING = np.diag([1.0, -1.0, -1.0])  # cam_from_target of a plate that faces the camera upright
ALL = np.ones((1, DOT_COUNT), dtype=np.bool_)
FOCAL_PX = 1400.0


def image_of(rotation: Array, translation_m: Array) -> Array:
    cam_m = dots_target_m(DEFAULT_U_M) @ rotation.T + translation_m
    assert cam_m[:, 2].min() > 0
    return (cam_m[:, :2] / cam_m[:, 2:])[None]


def tilted(tilt_rad: float, towards_rad: float, roll_rad: float) -> Array:
    """A plate tilted out of the image plane about an axis in it, after a roll."""
    axis = np.array([np.cos(towards_rad), np.sin(towards_rad), 0.0])
    return np.asarray(exp_rotation(tilt_rad * axis) @ exp_rotation(np.array([0.0, 0.0, roll_rad])) @ FACING)


angle = st.floats(-3.14, 3.14)
tilt = st.floats(0.0, 1.25)
place = st.tuples(st.floats(-0.5, 0.5), st.floats(-0.4, 0.4), st.floats(0.5, 8.0))


@given(tilt=tilt, towards=angle, roll=angle, place=place)
@settings(deadline=None)
def test_one_solution_is_exact_on_exact_dots(
    tilt: float, towards: float, roll: float, place: tuple[float, float, float]
) -> None:
    rotation = tilted(tilt, towards, roll)
    translation_m = np.array([place[0] * place[2], place[1] * place[2], place[2]])
    found = planar_poses(PLANE_M, image_of(rotation, translation_m), ALL)
    assert found.exists.all()
    # Rounding of 1e-16 on the image grows by depth over plate, at most 50, once for depth and once more for tilt.
    assert found.rms[0, 0] < 1e-13
    assert np.abs(found.rotations[0, 0] - rotation).max() < 1e-6
    assert np.abs(found.translations_m[0, 0] - translation_m).max() < 1e-6


@given(tilt=st.floats(0.2, 1.2), towards=angle, roll=angle, place=place)
@settings(deadline=None)
def test_closed_form_solutions_mirror_each_other_about_the_line_of_sight(
    tilt: float, towards: float, roll: float, place: tuple[float, float, float]
) -> None:
    translation_m = np.array([place[0] * place[2], place[1] * place[2], place[2]])
    normalised = image_of(tilted(tilt, towards, roll), translation_m)
    rotations = np.empty((2, 3, 3))
    solve_planar_pose(PLANE_M, normalised[0], np.ones(DOT_COUNT), rotations, np.empty((2, 3)))
    first, second = rotations[0, :, 2], rotations[1, :, 2]  # the plate's normals
    sight = translation_m / np.linalg.norm(translation_m)
    np.testing.assert_allclose(second, 2.0 * (first @ sight) * sight - first, atol=1e-6)
    np.testing.assert_allclose(np.linalg.det(rotations), 1.0, atol=1e-9)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_poses_are_proper_in_front_and_best_first_under_noise(seed: int) -> None:
    rng = np.random.default_rng(seed)
    translation_m = np.array([0.4, -0.3, 1.0]) * rng.uniform(1.0, 6.0)
    exact = image_of(tilted(rng.uniform(0.0, 1.1), *rng.uniform(-3.0, 3.0, 2)), translation_m)
    normalised = exact + rng.normal(0.0, 0.1 / FOCAL_PX, exact.shape)
    found = planar_poses(PLANE_M, normalised, ALL)
    np.testing.assert_allclose(np.linalg.det(found.rotations), 1.0, atol=1e-9)
    gram = found.rotations @ np.swapaxes(found.rotations, -1, -2)
    np.testing.assert_allclose(gram, np.broadcast_to(np.eye(3), gram.shape), atol=1e-9)
    assert found.rms[0, 0] <= found.rms[0, 1]
    # 32 coordinates less 6 unknowns: the rms is 0.09 px +- 12 %; five sigmas of that.
    assert found.rms[0, 0] * FOCAL_PX < 0.15
    cam_m = dots_target_m(DEFAULT_U_M) @ np.swapaxes(found.rotations[0], -1, -2) + found.translations_m[0, :, None]
    assert (cam_m[..., 2] > 0).all()


def test_refinement_reaches_the_stationary_point_of_both_minima() -> None:
    rng = np.random.default_rng(5)
    exact = image_of(tilted(0.5, 1.0, 0.3), np.array([0.4, 0.2, 4.0]))
    normalised = exact + rng.normal(0.0, 0.1 / FOCAL_PX, exact.shape)
    found = planar_poses(PLANE_M, normalised, ALL, PlanarPoseOptions(refinement_steps=30, converged=0.0))
    assert angle_between_deg(found.rotations[0, 0], found.rotations[0, 1]) > 20.0

    def squared_error(solution: int, step: Array) -> float:
        rotation = exp_rotation(step[3:]) @ found.rotations[0, solution]
        return float(((image_of(rotation, found.translations_m[0, solution] + step[:3]) - normalised) ** 2).sum())

    for solution in (0, 1):
        at_minimum = squared_error(solution, np.zeros(6))
        for axis in range(6):
            for sign in (-1.0, 1.0):
                assert squared_error(solution, sign * 1e-4 * np.eye(6)[axis]) > at_minimum


@pytest.mark.parametrize("cells", [(0, 3, 15, 12), (0, 5, 10, 3), (0, 1, 4, 5), (3, 5, 6, 9)])
def test_four_dots_are_enough_unless_they_are_collinear(cells: tuple[int, ...]) -> None:
    measured = np.zeros((1, DOT_COUNT), dtype=np.bool_)
    measured[0, list(cells)] = True
    rotation, translation_m = tilted(0.6, 0.7, -0.2), np.array([0.1, 0.2, 1.5])
    normalised = image_of(rotation, translation_m)
    normalised[~measured] = 17.0  # what was not measured has no say
    found = planar_poses(PLANE_M, normalised, measured)
    assert found.rms[0, 0] < 1e-12
    assert min(angle_between_deg(found.rotations[0, i], rotation) for i in (0, 1)) < 1e-4


@pytest.mark.parametrize("cells", [(), (0,), (0, 3, 15), (0, 1, 2, 3), (0, 5, 10, 15)])
def test_too_few_or_collinear_dots_give_no_pose_and_leave_the_other_targets_alone(cells: tuple[int, ...]) -> None:
    rotation, translation_m = tilted(0.6, 0.7, -0.2), np.array([0.1, 0.2, 1.5])
    normalised = np.repeat(image_of(rotation, translation_m), 2, axis=0)
    measured = np.ones((2, DOT_COUNT), dtype=np.bool_)
    measured[0] = np.isin(np.arange(DOT_COUNT), cells)
    found = planar_poses(PLANE_M, normalised, measured)
    assert found.exists.tolist() == [[False, False], [True, True]]
    np.testing.assert_allclose(found.rotations[1, 0], rotation, atol=1e-8)


def test_dots_in_one_image_point_give_no_pose() -> None:
    assert not planar_poses(PLANE_M, np.zeros((1, DOT_COUNT, 2)), ALL).exists.any()


def test_targets_are_solved_independently_of_their_batch() -> None:
    views = [image_of(tilted(t, 1.0, 0.5), np.array([0.1, 0.3, 2.0 + t])) for t in (0.1, 0.5, 1.0)]
    together = planar_poses(PLANE_M, np.concatenate(views), np.ones((3, DOT_COUNT), dtype=np.bool_))
    for index, view in enumerate(views):
        alone = planar_poses(PLANE_M, view, ALL)
        np.testing.assert_allclose(alone.rotations[0, 0], together.rotations[index, 0], atol=1e-9)
