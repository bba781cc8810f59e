from itertools import pairwise, permutations

import numpy as np
import pytest

from app.geometry.pose import Pose
from app.planning.depth_order import panels_in_view
from app.planning.posting import pose_facing
from app.planning.rays import RayGrid
from app.planning.room import box_panels
from app.planning.scene import Panel
from app.planning.surfaces import PlainSurface
from app.planning.survey_plan import look_at, phone_camera

RAYS = RayGrid(phone_camera(320, 240))
UP, NORTH = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
EYE = look_at(np.array([0.0, -3.0, 1.0]), np.array([0.0, 0.0, 1.0]))  # looks north


def facing_south(x_m: float, y_m: float, width_m: float = 1.0) -> Panel:
    return Panel(
        pose_facing(np.array([0.0, -1.0, 0.0]), UP, np.array([x_m, y_m, 1.0])), width_m, 1.0, PlainSurface((9, 9, 9))
    )


def upright(start: tuple[float, float], end: tuple[float, float], height_m: float) -> Panel:
    """A wall that shows its front to the left of who walks from start to end."""
    along = np.append(np.subtract(end, start), 0.0)
    middle = np.array([*(np.add(start, end) / 2), height_m / 2])
    pose = pose_facing(np.cross(UP, along), UP, middle)
    return Panel(pose, float(np.linalg.norm(along)), height_m, PlainSurface((9, 9, 9)))


def turned(pose: Pose) -> Pose:
    return Pose(pose.rotation @ np.diag([-1.0, 1.0, -1.0]), pose.position_m)


def order(panels: tuple[Panel, ...], eye: Pose = EYE) -> list[int]:
    return [next(i for i, p in enumerate(panels) if p is view.panel) for view in panels_in_view(panels, RAYS, eye)]


@pytest.mark.parametrize("listed", list(permutations(range(3))))
def test_the_nearer_is_painted_later_however_they_are_listed(listed: tuple[int, ...]) -> None:
    panels = [facing_south(0.0, y_m) for y_m in (2.0, 1.0, 0.0)]
    assert order(tuple(panels[i] for i in listed)) == [listed.index(i) for i in range(3)]


def test_of_panels_in_one_plane_the_later_listed_lies_on_top() -> None:
    small, large = facing_south(0.2, 1.0, 0.3), facing_south(0.0, 1.0, 2.0)
    assert order((large, small)) == [0, 1]
    assert order((small, large)) == [0, 1]


def test_a_long_wall_is_behind_what_stands_before_it_even_where_its_middle_is_nearer() -> None:
    slanted = Panel(
        pose_facing(np.array([-1.0, -0.2, 0.0]), UP, np.array([1.0, 0.0, 1.0])), 8.0, 2.0, PlainSurface((9, 9, 9))
    )
    before_it = facing_south(0.2, 2.5, 0.4)
    assert order((before_it, slanted)) == [1, 0]


def test_a_sheet_that_cuts_its_wall_a_little_still_lies_on_it() -> None:
    wall = facing_south(0.0, 1.0, 4.0)
    normal = np.array([0.001, -1.0, 0.0])
    sheet = Panel(pose_facing(normal, UP, np.array([0.3, 1.0, 1.0])), 0.2, 0.2, PlainSurface((9, 9, 9)))
    assert order((wall, sheet)) == [0, 1]


def test_what_shows_its_back_or_lies_outside_is_left_out() -> None:
    back = Panel(
        pose_facing(np.array([0.0, 1.0, 0.0]), UP, np.array([0.0, 1.0, 1.0])), 1.0, 1.0, PlainSurface((9, 9, 9))
    )
    behind, aside = facing_south(0.0, -5.0), facing_south(40.0, 1.0)
    assert order((back, behind, aside)) == []


def test_a_wall_that_passes_the_camera_is_clipped_to_the_frame() -> None:
    beside = Panel(
        pose_facing(np.array([1.0, 0.0, 0.0]), UP, np.array([-0.5, 0.0, 1.0])), 20.0, 3.0, PlainSurface((9, 9, 9))
    )
    (view,) = panels_in_view((beside,), RAYS, EYE)
    left, right, top, bottom = view.box_px
    assert (left, top, bottom) == (0, 0, 240)
    assert 100 < right < 160  # it ends short of the vanishing point in the middle


def test_a_box_shows_at_most_three_faces() -> None:
    panels = tuple(box_panels(np.array([0.5, 0.0, 0.2]), (0.4, 0.4, 0.4), (9, 9, 9)))
    assert len(panels_in_view(panels, RAYS, EYE)) == 3  # west, south, top


def test_panels_whose_planes_cut_each_other_are_told_by_what_is_nearer_where_both_are_seen() -> None:
    pillar = Panel(
        pose_facing(np.array([-1.0, -1.0, 0.0]), UP, np.array([0.0, 0.0, 1.0])), 0.3, 4.0, PlainSurface((9, 9, 9))
    )
    above = Panel(
        pose_facing(np.array([0.0, 0.0, -1.0]), NORTH, np.array([0.1, 2.0, 1.5])), 3.0, 3.0, PlainSurface((9, 9, 9))
    )
    # The ceiling's plane cuts the pillar, the pillar's plane the ceiling; the pillar stands before it.
    assert order((above, pillar)) == [0, 1]
    assert order((pillar, above)) == [1, 0]


def test_walls_beside_each_other_close_no_ring() -> None:
    """An L-shaped hall with a pillar, seen from beside the pillar: boxes overlap all round, outlines do not."""
    ring = [(0, 0), (14, 0), (14, 7.5), (11.5, 7.5), (11.5, 10), (0, 10)]
    walls = [upright(start, end, 4.2) for start, end in pairwise([*ring, ring[0]])]
    sides = [(6.8, 6.8), (6.8, 7.2), (7.2, 7.2), (7.2, 6.8)]
    pillar = [upright(start, end, 4.2) for start, end in pairwise([*sides, sides[0]])]
    inner = [Panel(turned(panel.site_from_panel), panel.width_m, panel.height_m, panel.surface) for panel in pillar]
    lamp = Panel(pose_facing(-UP, NORTH, np.array([7.0, 3.0, 4.15])), 1.2, 0.6, PlainSurface((9, 9, 9)))
    eye = look_at(np.array([7.375, 8.131, 1.559]), np.array([6.9, 4.0, 1.7]), np.pi / 2)
    panels = (*walls, *pillar, *inner, lamp)
    painted = order(panels, eye)
    fronts = [index for index in range(len(walls), len(walls) + len(pillar)) if index in painted]
    assert fronts and all(painted.index(front) > painted.index(len(panels) - 1) for front in fronts)
