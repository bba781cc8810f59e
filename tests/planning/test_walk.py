import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.planning.walk import STEADY_HZ, Gaze, WalkOptions, plan_walk

STEADY = WalkOptions(speed_m_s=1.0, rise_m=0.0, sway_m=0.0, unsteady_rad=0.0)
STRAIGHT = np.array([[0.0, 0.0, 1.5], [6.0, 0.0, 1.5]])
CORNER = np.array([[0.0, 0.0, 1.5], [4.0, 0.0, 1.5], [4.0, 4.0, 1.5]])


def test_a_straight_walk_goes_at_its_speed_and_looks_ahead() -> None:
    walk = plan_walk(STRAIGHT, Gaze(), STEADY, 1)
    assert walk.duration_s == pytest.approx(6.0)
    middle = walk.pose_at(3.0)
    assert middle.position_m == pytest.approx([3.0, 0.0, 1.5], abs=1e-6)
    assert middle.rotation[:, 2] == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)
    ahead_m = walk.pose_at(3.5).position_m - walk.pose_at(2.5).position_m
    assert np.linalg.norm(ahead_m) == pytest.approx(1.0, abs=1e-6)


def test_before_and_after_the_walk_the_phone_stands_still() -> None:
    walk = plan_walk(STRAIGHT, Gaze(), STEADY, 1)
    assert np.array_equal(walk.pose_at(-1.0).position_m, walk.pose_at(0.0).position_m)
    assert np.array_equal(walk.pose_at(99.0).position_m, walk.pose_at(walk.duration_s).position_m)


def test_corners_are_rounded_and_the_phone_turns_with_the_way() -> None:
    walk = plan_walk(CORNER, Gaze(), STEADY, 1)
    heading_rad = walk.angles_rad[:, 0]
    assert heading_rad[0] == pytest.approx(0.0, abs=0.01) and heading_rad[-1] == pytest.approx(np.pi / 2, abs=0.01)
    assert (np.diff(heading_rad) > -1e-9).all()
    # Rounded by turn_s, nobody turns a right angle faster than the Gaussian's peak.
    assert np.abs(np.diff(heading_rad)).max() * STEADY_HZ < np.pi / 2 / (np.sqrt(2 * np.pi) * STEADY.turn_s)


def test_the_gaze_may_lie_aside_or_at_a_place() -> None:
    aside = plan_walk(STRAIGHT, Gaze(aside_rad=np.pi / 2, up_rad=0.1), STEADY, 1).pose_at(3.0)
    assert aside.rotation[:, 2] == pytest.approx([0.0, np.cos(0.1), np.sin(0.1)], abs=1e-6)
    place_m = np.array([3.0, 2.0, 1.0])
    for time_s in (1.0, 3.0, 5.0):
        pose = plan_walk(STRAIGHT, Gaze(at_m=place_m), STEADY, 1).pose_at(time_s)
        in_cam_m = pose.inverse().apply(place_m)
        assert in_cam_m[:2] == pytest.approx([0.0, 0.0], abs=1e-4) and in_cam_m[2] > 0


@settings(deadline=None, max_examples=15)
@given(st.integers(0, 2**31 - 1))
def test_an_unsteady_hand_turns_by_its_sigma_and_no_seed_tells_another_way(seed: int) -> None:
    options = WalkOptions(rise_m=0.0, sway_m=0.0, unsteady_rad=0.02)
    long_m = np.array([[0.0, 0.0, 1.5], [200.0, 0.0, 1.5]])
    walk, again = (plan_walk(long_m, Gaze(), options, seed) for _ in range(2))
    assert np.array_equal(walk.angles_rad, again.angles_rad)
    # 200 s hold some 140 independent turns of 2 sqrt(pi) 0.4 s about each axis: sigma is known to 6 %.
    assert walk.angles_rad.std() == pytest.approx(0.02, rel=0.25)


@pytest.mark.parametrize(
    ("waypoints_m", "words"), [(STRAIGHT[:1], "two waypoints"), (STRAIGHT[[0, 0]], "the same place")]
)
def test_no_way_is_no_walk(waypoints_m: np.ndarray, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        plan_walk(waypoints_m, Gaze(), STEADY, 1)
