from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.vision.paper_ellipses import EllipseOptions, find_ellipses, fit_ellipse, red_channel

OPTIONS = EllipseOptions()
RED_BGR, GREEN_BGR, WHITE_BGR, BLACK_BGR = (36, 28, 200), (62, 150, 10), (232, 238, 238), (26, 24, 24)


def points_of_ellipse(centre: np.ndarray, axes: tuple[float, float], turn_rad: float, angles: np.ndarray) -> np.ndarray:
    along = np.column_stack([axes[0] * np.cos(angles), axes[1] * np.sin(angles)])
    turn = np.array([[np.cos(turn_rad), -np.sin(turn_rad)], [np.sin(turn_rad), np.cos(turn_rad)]])
    return along @ turn.T + centre


@given(
    x=st.floats(-50, 2000),
    y=st.floats(-50, 2000),
    major=st.floats(2, 60),
    ratio=st.floats(0.3, 0.99),
    turn=st.floats(0, 3.1),
)
def test_points_on_an_ellipse_give_its_centre_and_axes(
    x: float, y: float, major: float, ratio: float, turn: float
) -> None:
    angles = np.linspace(0.0, 2 * np.pi, 17)[:-1] + 0.1
    ellipse = fit_ellipse(points_of_ellipse(np.array([x, y]), (major, ratio * major), turn, angles))
    assert ellipse is not None
    np.testing.assert_allclose(ellipse.centre_px, [x, y], atol=1e-7)
    np.testing.assert_allclose(ellipse.semi_axes_px, [major, ratio * major], rtol=1e-7)
    assert ellipse.area_px2 == pytest.approx(np.pi * ratio * major**2, rel=1e-6)
    along = np.array([np.cos(turn), np.sin(turn)])
    assert ellipse.reach_px(along) == pytest.approx(major, rel=1e-6)


def test_the_centre_solves_the_conics_equations() -> None:
    # x^2 + 2 B x y + C y^2 + 2 D x + 2 E y + F: at the centre the gradient vanishes.
    b, c, d, e = 0.2, 2.0, -3.0, -5.0
    centre = np.array([(b * e - c * d) / (c - b * b), (b * d - e) / (c - b * b)])
    np.testing.assert_allclose([centre[0] + b * centre[1] + d, b * centre[0] + c * centre[1] + e], 0.0, atol=1e-12)
    values, vectors = np.linalg.eigh(np.array([[1.0, b], [b, c]]))
    circle = np.array([[np.cos(t), np.sin(t)] for t in np.arange(12) * np.pi / 6])
    ellipse = fit_ellipse(circle / np.sqrt(values) @ vectors.T + centre)
    assert ellipse is not None
    np.testing.assert_allclose(ellipse.centre_px, centre, atol=1e-9)


@pytest.mark.parametrize(
    "points",
    [
        np.column_stack([np.arange(9.0), 2 * np.arange(9.0)]),  # a line
        np.column_stack([np.linspace(-2, 2, 9), np.linspace(-2, 2, 9) ** 2]),  # a parabola
        np.array([[s * np.cosh(t), np.sinh(t)] for s in (-1, 1) for t in (-1.0, -0.5, 0.0, 0.5, 1.0)]),  # a hyperbola
        np.full((9, 2), 3.0),  # one point
    ],
)
def test_other_curves_are_no_ellipses(points: np.ndarray) -> None:
    ellipse = fit_ellipse(points)
    assert ellipse is None or max(ellipse.semi_axes_px) > 1e3  # rounding may close a parabola, far away


def test_only_red_is_deep() -> None:
    colours = np.array([[RED_BGR, GREEN_BGR, WHITE_BGR, BLACK_BGR]], dtype=np.uint8)
    assert red_channel(colours, 1.0)[0].tolist() == [164, 0, 0, 0]
    assert red_channel(colours, 2.0)[0, 0] == 255


def picture_of(shapes: list[tuple[tuple[int, int], tuple[int, int], tuple[int, int, int]]]) -> np.ndarray:
    picture = np.full((120, 160, 3), BLACK_BGR, dtype=np.uint8)
    for centre, axes, colour in shapes:
        cv2.ellipse(picture, centre, axes, 0.0, 0.0, 360.0, colour, -1, cv2.LINE_AA)
    return picture


def test_red_dots_are_found_where_they_are() -> None:
    centres = [(30, 40), (80, 40), (120, 80)]
    found = find_ellipses(picture_of([(centre, (9, 6), RED_BGR) for centre in centres]), OPTIONS)
    assert len(found) == 3
    for ellipse, centre in zip(sorted(found, key=lambda one: one.centre_px[0]), centres, strict=True):
        np.testing.assert_allclose(ellipse.centre_px, centre, atol=0.2)
        np.testing.assert_allclose(ellipse.semi_axes_px, [9, 6], atol=0.8)


@pytest.mark.parametrize(
    ("axes", "colour"),
    [((8, 8), GREEN_BGR), ((8, 8), WHITE_BGR), ((30, 5), RED_BGR), ((40, 40), RED_BGR)],
)
def test_what_is_not_red_too_flat_or_too_large_is_left_out(axes: tuple[int, int], colour: tuple[int, int, int]) -> None:
    assert find_ellipses(picture_of([((80, 60), axes, colour)]), OPTIONS) == []


@pytest.mark.parametrize(("area_min_px2", "found"), [(40.0, 1), (90.0, 0)])
def test_dots_below_the_least_area_are_left_out(area_min_px2: float, found: int) -> None:
    picture = picture_of([((80, 60), (4, 4), RED_BGR)])  # pi 4^2 = 50 px, and half a pixel of edge around it
    assert len(find_ellipses(picture, replace(OPTIONS, area_min_px2=area_min_px2))) == found


def test_a_red_square_and_the_rim_of_red_around_black_are_left_out() -> None:
    square = picture_of([])
    cv2.rectangle(square, (60, 40), (76, 56), RED_BGR, -1)
    cv2.rectangle(square, (66, 46), (70, 50), BLACK_BGR, -1)
    assert find_ellipses(square, OPTIONS) == []


def test_an_empty_picture_has_none() -> None:
    assert find_ellipses(np.zeros((1, 1, 3), dtype=np.uint8), OPTIONS) == []
