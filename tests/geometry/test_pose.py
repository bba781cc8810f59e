import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation

EXACT = 1e-12  # metres and matrix entries: double precision over positions of metres

vectors = st.lists(st.floats(-1.8, 1.8), min_size=3, max_size=3).map(np.array)
poses = st.builds(lambda turn, position: Pose(exp_rotation(turn), position), vectors, vectors)


def assert_same(first: Pose, second: Pose) -> None:
    np.testing.assert_allclose(first.rotation, second.rotation, atol=EXACT)
    np.testing.assert_allclose(first.position_m, second.position_m, atol=EXACT)


@given(poses, vectors)
def test_inverse_takes_points_back(site_from_cam: Pose, point_m: np.ndarray) -> None:
    np.testing.assert_allclose(site_from_cam.inverse().apply(site_from_cam.apply(point_m)), point_m, atol=EXACT)
    assert_same(site_from_cam.inverse().inverse(), site_from_cam)


@given(poses, poses, poses, vectors)
def test_composition_is_one_after_the_other_and_associative(a: Pose, b: Pose, c: Pose, point_m: np.ndarray) -> None:
    np.testing.assert_allclose(a.compose(b).apply(point_m), a.apply(b.apply(point_m)), atol=EXACT)
    assert_same(a.compose(b).compose(c), a.compose(b.compose(c)))


@given(poses)
def test_identity_is_neutral_and_a_pose_cancels_its_inverse(pose: Pose) -> None:
    identity = Pose(np.eye(3), np.zeros(3))
    assert_same(pose.compose(identity), pose)
    assert_same(identity.compose(pose), pose)
    assert_same(pose.compose(pose.inverse()), identity)


@given(poses)
def test_quaternion_and_position_tell_all(pose: Pose) -> None:
    assert_same(Pose.from_quaternion(pose.orientation_xyzw, pose.position_m), pose)


def test_points_of_any_shape_are_taken_along() -> None:
    pose = Pose(exp_rotation(np.array([0.1, 0.2, 0.3])), np.array([1.0, 2.0, 3.0]))
    points_m = np.random.default_rng(4).normal(size=(2, 5, 3))
    np.testing.assert_allclose(pose.apply(points_m)[1, 4], pose.rotation @ points_m[1, 4] + pose.position_m)


def test_position_of_a_camera_is_its_projection_centre() -> None:
    site_from_cam = Pose(exp_rotation(np.array([0.3, -0.2, 1.0])), np.array([4.0, 5.0, 1.5]))
    np.testing.assert_allclose(site_from_cam.apply(np.zeros(3)), site_from_cam.position_m)


@given(poses, vectors, vectors)
def test_steps_turn_in_the_axes_of_the_site(pose: Pose, shift_m: np.ndarray, turn_rad: np.ndarray) -> None:
    moved = pose.moved(np.concatenate([shift_m, turn_rad]))
    assert_same(moved, Pose(exp_rotation(turn_rad) @ pose.rotation, pose.position_m + shift_m))


def test_rotations_stay_proper_after_many_steps() -> None:
    pose, step = Pose(np.eye(3), np.zeros(3)), np.array([0.0, 0.0, 0.0, 0.7, -0.4, 0.9])
    for _ in range(5_000):
        pose = pose.moved(step)
    np.testing.assert_allclose(pose.rotation @ pose.rotation.T, np.eye(3), atol=1e-14)


@pytest.mark.parametrize(
    ("rotation", "position_m"),
    [
        (np.diag([1.0, 1.0, -1.0]), np.zeros(3)),
        (np.eye(3) * 1.01, np.zeros(3)),
        (np.eye(3) + 2e-6 * np.eye(3)[[1, 0, 2]], np.zeros(3)),
        (np.diag([1.0, 1.0, 1.0 + 2e-6]), np.zeros(3)),
        (np.eye(3), np.array([0.0, np.nan, 0.0])),
        (np.eye(3), np.zeros(2)),
        (np.eye(2), np.zeros(3)),
    ],
)
def test_what_is_no_pose_is_refused(rotation: np.ndarray, position_m: np.ndarray) -> None:
    with pytest.raises(ValueError, match=r"pose takes|rotation must"):
        Pose(rotation, position_m)
