import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.targets.layout import dots_target_m

U_M = 0.014
ORIGIN_M = np.array([1.0, -2.0, 0.5])

vectors = st.lists(st.floats(-5.0, 5.0), min_size=3, max_size=3).map(np.array)


def a_datum() -> Datum:
    root = np.random.default_rng(9).normal(size=(7, 7)) * 1e-3
    return Datum(ORIGIN_M, root @ root.T)


def moved(point_m: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """The small similarity itself, not linearised: about the origin, then shifted."""
    turned = np.exp(parameters[6]) * exp_rotation(parameters[3:6]) @ (point_m - ORIGIN_M)
    return np.asarray(ORIGIN_M + turned + parameters[:3])


def a_target(code: int, position_m: np.ndarray) -> MappedTarget:
    pose = Pose(exp_rotation(np.array([0.1, 0.2, 0.3])), position_m)
    return MappedTarget(code, pose, pose.apply(dots_target_m(U_M)), np.eye(6) * 1e-6, rays=3, rms_px=0.1)


@given(vectors)
def test_point_jacobian_meets_central_differences(point_m: np.ndarray) -> None:
    jacobian, step = a_datum().point_jacobian(point_m), 1e-5
    for index in range(7):
        shift = np.eye(7)[index] * step
        difference = (moved(point_m, shift) - moved(point_m, -shift)) / (2 * step)
        # Third derivatives are at most 12 m here: 12 step^2 / 6, and rounding of 1e-15 / step.
        np.testing.assert_allclose(jacobian[:, index], difference, atol=1e-8)


def test_jacobians_of_many_points_are_those_of_each() -> None:
    points_m = np.random.default_rng(10).normal(size=(4, 3))
    stacked = a_datum().point_jacobian(points_m)
    assert stacked.shape == (4, 3, 7)
    np.testing.assert_array_equal(stacked[2], a_datum().point_jacobian(points_m[2]))


def test_pose_covariance_is_what_redrawn_datums_scatter() -> None:
    datum, rng = a_datum(), np.random.default_rng(11)
    position_m, draws = np.array([3.0, 1.0, 2.0]), 20_000
    parameters = rng.multivariate_normal(np.zeros(7), datum.covariance, draws)
    positions_m = np.stack([moved(position_m, row) for row in parameters])
    scatter = np.cov(np.column_stack([positions_m, parameters[:, 3:6]]).T)
    covariance = datum.pose_covariance(position_m)
    # A sample covariance scatters by sqrt(2 / draws) of its variances: 1 %; five of these keep chance out.
    scale = np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))
    assert (np.abs(scatter - covariance) / scale).max() < 5.0 * np.sqrt(2.0 / draws)


def test_translation_alone_moves_positions_and_turns_nothing() -> None:
    covariance = np.zeros((7, 7))
    covariance[:3, :3] = np.diag([1.0, 4.0, 9.0])
    expected = np.zeros((6, 6))
    expected[:3, :3] = covariance[:3, :3]
    np.testing.assert_allclose(Datum(ORIGIN_M, covariance).pose_covariance(np.array([7.0, 8.0, 9.0])), expected)


def test_a_map_finds_its_targets_and_knows_its_box() -> None:
    first, second = a_target(389, np.zeros(3)), a_target(778, np.array([4.0, 3.0, 2.0]))
    target_map = TargetMap((first, second), a_datum(), "golay", U_M)
    assert target_map.by_code[778] is second
    least_m, greatest_m = target_map.bounds_m()
    dots_m = np.concatenate([first.dots_m, second.dots_m])
    np.testing.assert_array_equal([least_m, greatest_m], [dots_m.min(axis=0), dots_m.max(axis=0)])


def test_a_code_stands_once_in_a_map() -> None:
    with pytest.raises(ValueError, match="once in a target map"):
        TargetMap((a_target(389, np.zeros(3)), a_target(389, np.ones(3))), a_datum(), "golay", U_M)


def test_malformed_targets_are_refused() -> None:
    pose = Pose(np.eye(3), np.zeros(3))
    with pytest.raises(ValueError, match="sixteen dots"):
        MappedTarget(389, pose, np.zeros((5, 3)), np.eye(6), 3, 0.1)
    with pytest.raises(ValueError, match="sixteen dots"):
        MappedTarget(389, pose, np.zeros((16, 3)), np.eye(3), 3, 0.1)
