"""What is said of dots before they are seen: round for a circle, by its perimeter, worse across a slanted one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.planning.dot_errors import LIGHTS, DotErrorOptions, dot_information

NO_BLUR = DotErrorOptions(blur_px=1e-9)


@given(st.floats(1.0, 40.0), st.floats(-np.pi, np.pi))
def test_a_circle_is_placed_alike_in_all_directions(radius_px: float, turn_rad: float) -> None:
    turn = np.array([[np.cos(turn_rad), -np.sin(turn_rad)], [np.sin(turn_rad), np.cos(turn_rad)]])
    information = dot_information(radius_px * turn, "indoor", NO_BLUR)
    # Information grows with the perimeter: sigma of a circle of 1 px over the root of the radius.
    np.testing.assert_allclose(information, radius_px / NO_BLUR.indoor**2 * np.eye(2), rtol=1e-9, atol=1e-9)


def test_a_slanted_dot_is_placed_worse_along_its_length() -> None:
    information = dot_information(np.diag([6.0, 3.0]), "indoor")
    assert information[0, 0] < information[1, 1]
    # Against the sum over so fine a rim that it stands for the integral.
    angle = (np.arange(20000) + 0.5) * 2 * np.pi / 20000
    along = np.column_stack([-6 * np.sin(angle), 3 * np.cos(angle)])
    length = np.linalg.norm(along, axis=1)
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
    rim = np.einsum("ki,kj,k->ij", normal, normal, length) * 2 / 20000
    options = DotErrorOptions()
    share = 1 / (1 + (options.blur_px / 3.0) ** 4)
    np.testing.assert_allclose(information, rim * share / options.indoor**2, rtol=1e-3, atol=1e-6)


def test_less_light_and_smaller_dots_say_less() -> None:
    traces = [np.trace(dot_information(4.0 * np.eye(2), light)) for light in LIGHTS]
    assert traces[0] > traces[1] > traces[2]
    small, large = (np.trace(dot_information(radius * np.eye(2), "indoor")) for radius in (2.0, 4.0))
    assert small == pytest.approx(large / 2 * (1 + 0.5**4) / 2, rel=1e-6)
