import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from app.targets.layout import (
    BASE_CELLS,
    CELLS_PER_SIDE,
    DIGIT_CELLS,
    DOT_COUNT,
    DOT_PITCH_U,
    EDGE_TO_DOT_U,
    PLATE_SIDE_U,
    cell_of_dot,
    dot_centres_u,
    dots_target_m,
)

A, B, C, D, E = BASE_CELLS
CROSS_RATIO = 0.5  # targets.md: (ab, fc) of E, A, the diagonals' crossing and C


def crossing(first: np.ndarray, second: np.ndarray, third: np.ndarray, fourth: np.ndarray) -> np.ndarray:
    """Where the line of the first two points meets the line of the last two."""
    lines = [np.cross([*p, 1.0], [*q, 1.0]) for p, q in ((first, second), (third, fourth))]
    x, y, w = np.cross(*lines)
    return np.array([x / w, y / w])


def directed_cross_ratio(dots: np.ndarray) -> float:
    """(ab, fc) = (af * bc) / (ac * bf) with a = E, b = A, c = C and f the crossing of the diagonals."""
    f = crossing(dots[A], dots[C], dots[B], dots[D])
    along = dots[C] - dots[A]
    a, b, c, f_at = (float(point @ along) for point in (dots[E], dots[A], dots[C], f))
    return ((f_at - a) * (c - b)) / ((c - a) * (f_at - b))


def test_base_dots_stand_where_the_plate_says() -> None:
    dots = dot_centres_u()
    half = PLATE_SIDE_U / 2 - EDGE_TO_DOT_U
    np.testing.assert_array_equal(dots[[A, B, C, D]], [[-half, half], [half, half], [half, -half], [-half, -half]])
    np.testing.assert_allclose(dots[E], dots[A] + (dots[C] - dots[A]) / 3)
    assert sorted((*BASE_CELLS, *DIGIT_CELLS)) == list(range(DOT_COUNT))
    assert DIGIT_CELLS == (1, 2, 4, 6, 7, 8, 9, 10, 11, 13, 14)


def test_neighbours_stand_one_pitch_apart() -> None:
    grid = dot_centres_u().reshape(CELLS_PER_SIDE, CELLS_PER_SIDE, 2)
    assert (np.diff(grid, axis=1) == [DOT_PITCH_U, 0.0]).all()
    assert (np.diff(grid, axis=0) == [0.0, -DOT_PITCH_U]).all()
    np.testing.assert_allclose(grid.mean(axis=(0, 1)), 0.0)


def test_metres_follow_the_module_and_the_print_scale() -> None:
    dots_m = dots_target_m(0.014, (1.002, 0.999))
    np.testing.assert_allclose(dots_m[:, :2], dot_centres_u() * [0.014 * 1.002, 0.014 * 0.999])
    assert (dots_m[:, 2] == 0.0).all()


def test_dot_names() -> None:
    assert [cell_of_dot(name) for name in "ABCDE"] == list(BASE_CELLS)
    assert [cell_of_dot(f"r{cell // 4}c{cell % 4}") for cell in range(DOT_COUNT)] == list(range(DOT_COUNT))
    assert cell_of_dot("centre") is None


@pytest.mark.parametrize("name", ["F", "", "r4c0", "r0c4", "r0c", "a", "center", "r00c1"])
def test_other_dot_names_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match="none of"):
        cell_of_dot(name)


@given(st.lists(st.floats(-1.0, 1.0), min_size=9, max_size=9))
def test_cross_ratio_is_a_half_under_every_perspective_view(entries: list[float]) -> None:
    homography = np.array(entries).reshape(3, 3)
    homography[2] *= 0.1  # a plate that reaches neither behind the camera nor to the horizon
    homography[2, 2] = 1.0
    assume(abs(np.linalg.det(homography)) > 0.05)
    projected = np.column_stack([dot_centres_u(), np.ones(DOT_COUNT)]) @ homography.T
    assume(projected[:, 2].min() > 0.05)
    dots = projected[:, :2] / projected[:, 2:]
    assume(np.linalg.norm(dots[C] - dots[A]) > 0.1 and np.linalg.norm(dots[D] - dots[B]) > 0.1)
    # Rounding, amplified by how flat the view is; the bounds above keep it below 1e-6.
    assert directed_cross_ratio(dots) == pytest.approx(CROSS_RATIO, abs=1e-6)
