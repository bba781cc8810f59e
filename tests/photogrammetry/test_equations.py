"""Weighted equations of poses and points: derivatives against central differences."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.geometry.rotation import exp_rotation
from app.photogrammetry.equations import PointEquations, PoseEquations
from app.photogrammetry.network import Network, NetworkStep
from tests.photogrammetry.survey_scene import U_M
from tests.photogrammetry.true_network import small_truth

STEP = 1e-6
small = st.floats(-0.1, 0.1)


def network() -> Network:
    return small_truth().network


@given(turn=st.tuples(small, small, small), shift=st.tuples(small, small, small))
def test_pose_residuals_are_what_the_pose_is_off(turn: tuple[float, ...], shift: tuple[float, ...]) -> None:
    truth = network()
    known = PoseEquations(np.array([3]), truth.target_rotations[[3]], truth.target_positions_m[[3]], np.eye(6)[None])
    rotations, positions_m = truth.target_rotations.copy(), truth.target_positions_m.copy()
    rotations[3] = exp_rotation(np.array(turn)) @ rotations[3]
    positions_m[3] += shift
    np.testing.assert_allclose(known.residuals(rotations, positions_m)[0], [*shift, *turn], atol=1e-12)


@given(turn=st.tuples(small, small, small))
def test_pose_jacobian(turn: tuple[float, ...]) -> None:
    truth = network()
    known = PoseEquations(np.array([0]), truth.target_rotations[[0]], truth.target_positions_m[[0]], np.eye(6)[None])
    rotations = exp_rotation(np.array(turn)) @ truth.target_rotations
    jacobian = known.jacobian(known.residuals(rotations, truth.target_positions_m))[0]
    for column in range(3):
        axis = STEP * np.eye(3)[column]
        ahead, back = (
            known.residuals(exp_rotation(sign * axis) @ rotations, truth.target_positions_m)[0] for sign in (1, -1)
        )
        # The series is cut after the second order of a turn of at most 0.17 rad: the next term is 0.17^4 / 720.
        np.testing.assert_allclose(jacobian[:, 3 + column], (ahead - back) / (2 * STEP), atol=1e-5)


def test_point_jacobian() -> None:
    truth = network()
    points = PointEquations(
        np.array([1, 4]), np.array([[0.02, -0.03], [0.0, 0.0]]), np.zeros((2, 3)), np.array([0.001, 0.002])
    )
    jacobian = points.jacobian(truth)
    for column in range(8):
        targets = np.zeros((len(truth.target_rotations), 6))
        step = NetworkStep(np.zeros((3, 6)), targets, np.zeros((1, 9)), np.zeros((len(targets), 2)))
        if column < 6:
            step.targets[:, column] = STEP
        else:
            step.print_scale[:, column - 6] = STEP
        back = NetworkStep(-step.photos, -step.targets, -step.intrinsics, -step.print_scale)
        expected = (points.residuals(truth.moved(step)) - points.residuals(truth.moved(back))) / (2 * STEP)
        np.testing.assert_allclose(jacobian[..., column], expected, rtol=1e-6, atol=1e-5)


def test_points_of_the_truth_stand_where_the_dots_are() -> None:
    truth = network()
    corner_m = np.array([-4.5, 4.5]) * U_M
    points = PointEquations(np.array([2]), corner_m[None], truth.dots_m(U_M)[[2], 0], np.array([0.001]))
    np.testing.assert_allclose(points.residuals(truth), 0.0, atol=1e-9)
