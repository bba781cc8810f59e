import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.geometry.rotation import (
    angle_between_deg,
    exp_rotation,
    log_rotation,
    photogrammetric_angles_deg,
    quaternion_xyzw,
    rotation_of_quaternion,
    skew,
)

# Double precision through a handful of products; nothing here is ill-conditioned away from half turns.
EXACT = 1e-12

vectors = st.lists(st.floats(-1.8, 1.8), min_size=3, max_size=3).map(np.array)  # shorter than pi
rotations = vectors.map(exp_rotation)


def about(axis: int, angle_rad: float) -> np.ndarray:
    return exp_rotation(np.eye(3)[axis] * angle_rad)


@given(vectors, vectors)
def test_skew_is_the_cross_product(first: np.ndarray, second: np.ndarray) -> None:
    np.testing.assert_allclose(skew(first) @ second, np.cross(first, second), atol=EXACT)


@given(vectors)
def test_exponential_gives_proper_rotations_that_keep_their_axis(vector: np.ndarray) -> None:
    rotation = exp_rotation(vector)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=EXACT)
    assert np.linalg.det(rotation) == pytest.approx(1.0, abs=EXACT)
    np.testing.assert_allclose(rotation @ vector, vector, atol=EXACT)


@given(vectors)
def test_logarithm_undoes_the_exponential(vector: np.ndarray) -> None:
    # Near a half turn the sine that carries the axis is small: 1e-9 covers its loss of digits.
    np.testing.assert_allclose(log_rotation(exp_rotation(vector)), vector, atol=1e-9)


@given(vectors, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_turns_about_one_axis_add_up(vector: np.ndarray, first: float, second: float) -> None:
    together = exp_rotation(vector * (first + second))
    np.testing.assert_allclose(exp_rotation(vector * first) @ exp_rotation(vector * second), together, atol=EXACT)


@pytest.mark.parametrize("size", [0.0, 1e-9, 9.99e-7, 1.01e-6, 1e-4])
def test_small_rotations_meet_the_series(size: float) -> None:
    vector = np.array([0.6, -0.48, 0.64]) * size
    cross = skew(vector)
    series = np.eye(3) + cross + cross @ cross / 2 + cross @ cross @ cross / 6
    np.testing.assert_allclose(exp_rotation(vector), series, atol=1e-15)  # the next term is size^4 / 24


def test_stacks_of_rotations_are_turned_one_by_one() -> None:
    stack = np.random.default_rng(3).normal(size=(4, 5, 3))
    turned = exp_rotation(stack)
    assert turned.shape == (4, 5, 3, 3)
    np.testing.assert_allclose(turned[2, 3], exp_rotation(stack[2, 3]), atol=EXACT)


@given(rotations)
def test_quaternions_return_their_rotation(rotation: np.ndarray) -> None:
    quaternion = quaternion_xyzw(rotation)
    assert quaternion[3] >= 0 and np.linalg.norm(quaternion) == pytest.approx(1.0, abs=EXACT)
    for same in (quaternion, -quaternion, 3.0 * quaternion):
        np.testing.assert_allclose(rotation_of_quaternion(same), rotation, atol=EXACT)


@given(
    phi_rad=st.floats(-3.0, 3.0), omega_rad=st.floats(-1.5, 1.5), kappa_rad=st.floats(-3.0, 3.0)
)  # omega stays 4 degrees away from the singularity
def test_photogrammetric_angles_are_those_of_their_definition(
    phi_rad: float, omega_rad: float, kappa_rad: float
) -> None:
    with_flip = about(1, -phi_rad) @ about(0, omega_rad) @ about(2, kappa_rad)
    angles = photogrammetric_angles_deg(with_flip @ np.diag([1.0, -1.0, -1.0]))
    assert angles is not None
    np.testing.assert_allclose(np.radians(angles), [phi_rad, omega_rad, kappa_rad], atol=1e-9)


def test_zero_angles_are_half_a_turn_about_x() -> None:
    angles = photogrammetric_angles_deg(rotation_of_quaternion(np.array([1.0, 0.0, 0.0, 0.0])))
    assert angles is not None
    np.testing.assert_allclose(angles, 0.0, atol=1e-12)


@pytest.mark.parametrize(("tilt_deg", "reported"), [(0.0, False), (0.9, False), (1.1, True)])
def test_angles_are_null_near_the_view_along_y(tilt_deg: float, reported: bool) -> None:
    rotation = about(0, np.radians(90.0 - tilt_deg)) @ np.diag([1.0, -1.0, -1.0])
    assert (photogrammetric_angles_deg(rotation) is not None) == reported


@given(rotations, vectors)
def test_angle_between_is_the_turn_from_one_to_the_other(rotation: np.ndarray, vector: np.ndarray) -> None:
    turned = exp_rotation(vector) @ rotation
    angle_deg = np.degrees(np.linalg.norm(log_rotation(exp_rotation(vector))))
    assert angle_between_deg(turned, rotation) == pytest.approx(angle_deg, abs=1e-6)
    assert angle_between_deg(rotation, turned) == pytest.approx(angle_deg, abs=1e-6)
