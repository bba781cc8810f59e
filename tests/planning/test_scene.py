import numpy as np
import pytest

from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.planning.scene import Panel, PostedTarget, Scene
from app.planning.surfaces import PlainSurface
from app.targets.layout import dots_target_m

POSE = Pose(exp_rotation(np.array([0.3, -0.5, 0.2])), np.array([1.0, 2.0, 3.0]))


def test_dots_of_a_posted_target_stand_in_the_site() -> None:
    target = PostedTarget(389, POSE, 0.014, print_scale_xy=(1.002, 0.998))
    np.testing.assert_allclose(target.dots_m(), POSE.apply(dots_target_m(0.014, (1.002, 0.998))))


def test_the_sheet_is_the_plate_and_its_margin() -> None:
    panel = PostedTarget(389, POSE, 0.014, paper_margin_u=2.0).panel()
    assert (panel.width_m, panel.height_m) == pytest.approx((17 * 0.014, 17 * 0.014))


def test_corners_run_clockwise_from_the_top_left() -> None:
    panel = Panel(POSE, 4.0, 2.0, PlainSurface((1, 2, 3)))
    expected_m = np.array([[-2, 1, 0], [2, 1, 0], [2, -1, 0], [-2, -1, 0]])
    np.testing.assert_allclose(POSE.inverse().apply(panel.corners_m()), expected_m, atol=1e-12)


def test_targets_lie_on_top_of_all_panels() -> None:
    wall = Panel(POSE, 4.0, 2.0, PlainSurface((1, 2, 3)))
    target = PostedTarget(389, POSE, 0.014)
    assert Scene((target,), (wall,)).all_panels()[0] is wall
    assert len(Scene((target,), (wall,)).all_panels()) == 2


def test_panels_without_size_are_refused() -> None:
    with pytest.raises(ValueError, match="positive width"):
        Panel(POSE, 0.0, 1.0, PlainSurface((1, 2, 3)))
