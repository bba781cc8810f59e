import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from app.targets.layout import BASE_CELLS
from app.vision.homography import PLATE_DOTS_U
from app.vision.paper_ellipses import Ellipse
from app.vision.paper_groups import GroupOptions, alike_and_apart, arrange, group_base_dots

OPTIONS = GroupOptions()
BASE_U = PLATE_DOTS_U[list(BASE_CELLS)]  # A, B, C, D, E; y down as in the picture


def circle(x_px: float, y_px: float, radius_px: float = 3.0, ratio: float = 1.0) -> Ellipse:
    shape = np.diag([radius_px**2, (ratio * radius_px) ** 2])
    return Ellipse(np.array([x_px, y_px]), (radius_px, ratio * radius_px), shape)


def seen(points_u: np.ndarray, turn_rad: float, slant_rad: float, towards_rad: float, distance_u: float) -> np.ndarray:
    """Plate points in a picture of focal length 1,000 px, the plate's middle straight ahead."""
    plane = np.column_stack([points_u, np.zeros(len(points_u))])

    def about_z(angle: float) -> np.ndarray:
        return np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])

    slant = np.array([[1, 0, 0], [0, np.cos(slant_rad), -np.sin(slant_rad)], [0, np.sin(slant_rad), np.cos(slant_rad)]])
    turned = plane @ (about_z(towards_rad) @ slant @ about_z(-towards_rad) @ about_z(turn_rad)).T + [0, 0, distance_u]
    return turned[:, :2] / turned[:, 2:] * 1000


@given(
    turn=st.floats(0, 6.3),
    slant=st.floats(0, 1.05),  # 60 degrees
    towards=st.floats(0, 6.3),
    distance_u=st.floats(40, 400),
    order=st.permutations(range(5)),
)
def test_base_dots_are_named_in_every_view_and_order(
    turn: float, slant: float, towards: float, distance_u: float, order: list[int]
) -> None:
    centres_px = seen(BASE_U, turn, slant, towards, distance_u)
    named = arrange(centres_px[order], OPTIONS)
    assert named is not None
    assert [order[i] for i in named] == [0, 1, 2, 3, 4]


@given(
    e_cell=st.sampled_from([1, 2, 4, 7, 8, 11, 13, 14]), turn=st.floats(0, 6.3), slant=st.floats(0, 0.7)
)  # E off both diagonals
def test_plates_of_wrong_structure_are_no_targets(e_cell: int, turn: float, slant: float) -> None:
    wrong_u = np.vstack([BASE_U[:4], PLATE_DOTS_U[e_cell]])
    assert arrange(seen(wrong_u, turn, slant, 0.3, 100.0), OPTIONS) is None


@given(
    turn=st.floats(0, 6.3),
    noise=st.lists(st.floats(-1.5, 1.5), min_size=10, max_size=10),
    order=st.permutations(range(5)),
)
def test_whatever_is_arranged_is_a_clockwise_target(turn: float, noise: list[float], order: list[int]) -> None:
    points_px = seen(BASE_U + np.array(noise).reshape(5, 2), turn, 0.5, 1.0, 100.0)[order]
    named = arrange(points_px, OPTIONS)
    assume(named is not None)
    a, b, c, d, e = points_px[named]
    x, y = np.stack([a, b, c, d]).T
    assert x @ np.roll(y, -1) - y @ np.roll(x, -1) > 0  # clockwise: y is down
    assert 0 < (e - a) @ (c - a) < (c - a) @ (c - a)  # E lies between A and C


def test_five_points_in_one_place_are_nothing() -> None:
    assert arrange(np.zeros((5, 2)), OPTIONS) is None


def test_alike_means_of_one_size_and_apart() -> None:
    row = [circle(20.0 * i, 0.0) for i in range(5)]
    assert alike_and_apart(row, OPTIONS)
    assert not alike_and_apart([*row[:4], circle(80.0, 0.0, radius_px=6.5)], OPTIONS)
    assert not alike_and_apart([*row[:4], circle(80.0, 0.0, ratio=0.45)], OPTIONS)
    assert not alike_and_apart([*row[:4], circle(65.5, 0.0)], OPTIONS)  # cuts the fourth
    assert not alike_and_apart([*row[:4], circle(60.0, 0.0, radius_px=2.0)], OPTIONS)  # inside the fourth


def test_flat_dots_side_by_side_do_not_cut_each_other() -> None:
    flat = [circle(0.0, 4.0 * i, radius_px=3.0, ratio=0.6) for i in range(5)]
    assert alike_and_apart(flat, OPTIONS)


@pytest.mark.parametrize("distance_u", [150.0, 400.0])
def test_neighbouring_targets_are_told_apart(distance_u: float) -> None:
    shifts_u = np.outer([-17.0, 0.0, 17.0], [1.0, 0.3])
    picture = np.vstack([seen(BASE_U + shift_u, 0.2, 0.5, 1.0, distance_u) for shift_u in shifts_u])
    radius_px = 0.9 * 1000 / distance_u
    ellipses = [circle(x, y, radius_px, 0.85) for x, y in picture]
    groups, refused = group_base_dots(ellipses, OPTIONS)
    assert sorted(groups) == [[0, 1, 2, 3, 4], [5, 6, 7, 8, 9], [10, 11, 12, 13, 14]]
    assert refused == []


def test_five_that_are_no_target_are_reported() -> None:
    pentagon = [circle(50 * np.cos(t), 50 * np.sin(t)) for t in np.arange(5) * 2 * np.pi / 5]
    groups, refused = group_base_dots(pentagon, OPTIONS)
    assert groups == [] and sorted(refused[0]) == [0, 1, 2, 3, 4]


def test_fewer_than_five_are_nothing() -> None:
    assert group_base_dots([], OPTIONS) == ([], [])
    assert group_base_dots([circle(10.0 * i, 0.0) for i in range(4)], OPTIONS) == ([], [])
