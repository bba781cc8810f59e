"""The compiled small rotation beside the one of arrays."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.geometry.kernels.rotation import turn_rotation
from app.geometry.rotation import exp_rotation

angles = st.floats(-3.0, 3.0)


@given(
    first=st.tuples(angles, angles, angles),
    turn=st.tuples(angles, angles, angles),
    scale=st.sampled_from([1.0, 1e-4, 1e-9]),
)
def test_turning_is_the_exponential_map(first: tuple[float, ...], turn: tuple[float, ...], scale: float) -> None:
    rotation, turn_rad = exp_rotation(np.array(first)), scale * np.array(turn)
    turned = np.empty((3, 3))
    turn_rotation(rotation, turn_rad, turned)
    np.testing.assert_allclose(turned, exp_rotation(turn_rad) @ rotation, atol=1e-12)


def test_ten_thousand_turns_leave_a_rotation() -> None:
    rotation = np.eye(3)
    for _ in range(10_000):
        turn_rotation(rotation, np.array([0.01, -0.02, 0.03]), rotation)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-14)
