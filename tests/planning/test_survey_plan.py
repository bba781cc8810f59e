import numpy as np
import pytest

from app.errors import InvalidInput
from app.planning.posting import RoomOptions
from app.planning.room import build_room
from app.planning.sight import see
from app.planning.survey_plan import StationOptions, look_at, phone_camera, plan_stations, small_room, survey_control
from app.targets.family import family_by_name

GOLAY = family_by_name("golay")


def test_a_camera_sees_in_its_middle_what_it_is_aimed_at_and_stands_upright() -> None:
    eye_m, aim_m = np.array([1.0, 2.0, 1.5]), np.array([4.0, 3.0, 1.0])
    pose = look_at(eye_m, aim_m)
    np.testing.assert_array_equal(pose.position_m, eye_m)
    in_camera_m = pose.inverse().apply(aim_m)
    np.testing.assert_allclose(in_camera_m, [0.0, 0.0, np.linalg.norm(aim_m - eye_m)], atol=1e-12)
    assert pose.inverse().rotation[1, 2] < 0  # up in the site is up in the picture
    turned = look_at(eye_m, aim_m, np.pi / 2)
    np.testing.assert_allclose(turned.rotation[:, 0], pose.rotation[:, 1], atol=1e-12)


def test_there_is_no_upright_straight_up() -> None:
    with pytest.raises(ValueError, match="straight up"):
        look_at(np.zeros(3), np.array([0.0, 0.0, 1.0]))


def test_stations_stand_in_the_room_and_look_across_it() -> None:
    size_m = (5.0, 4.0, 2.6)
    stations = plan_stations(size_m, StationOptions(count=16), seed=4)
    assert len(stations) == 16
    for station in stations:
        assert (station.position_m > 0).all() and (station.position_m < size_m).all()
        inwards_m = np.array(size_m[:2]) / 2 - station.position_m[:2]
        assert station.rotation[:2, 2] @ inwards_m > 0.7 * np.linalg.norm(inwards_m)
    upright = [abs(station.rotation[2, 0]) > 0.9 for station in stations]
    assert sum(upright) == 4


def test_control_points_lie_apart_with_the_noise_they_claim() -> None:
    targets = build_room(RoomOptions(targets=200, size_m=(10.0, 9.0, 3.0)), GOLAY, seed=5).targets
    by_code = {target.code: target for target in targets}
    points = survey_control(targets, (4, 150), 0.001, seed=6)
    assert [point.role for point in points[:5]] == ["control"] * 4 + ["check"]
    assert len({point.code for point in points}) == len({point.name for point in points}) == 154
    errors_m = [point.position_m - by_code[point.code].dots_m()[point.cell] for point in points]
    # 462 numbers fix a standard deviation to 3.3 %; three of these.
    assert np.std(errors_m) == pytest.approx(0.001, rel=0.1)
    control_m = np.stack([point.position_m for point in points[:4]])
    assert np.linalg.svd(control_m - control_m.mean(axis=0))[1][1] > 1.0  # far from lying on one line


def test_points_need_targets() -> None:
    targets = build_room(RoomOptions(targets=5, wrong_targets=3), GOLAY, seed=5).targets
    with pytest.raises(InvalidInput, match="6 points need as many targets, there are 5"):
        survey_control(targets, (4, 2), 0.001, seed=6)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_small_room_is_a_survey_that_can_be_adjusted(seed: int) -> None:
    plan = small_room(GOLAY, seed)
    rays = {target.code: 0 for target in plan.scene.targets}
    for station in plan.stations:
        whole = [target for target in see(plan.scene, plan.camera, station) if target.whole]
        assert len(whole) >= 3
        for target in whole:
            rays[target.code] += 1
    assert min(rays.values()) >= 3


def test_phone_cameras_keep_their_lens_in_both_frames() -> None:
    wide, upright = phone_camera(640, 480), phone_camera(480, 640)
    assert wide.fx_px == upright.fx_px
    np.testing.assert_array_equal(wide.intrinsics[4:], upright.intrinsics[4:])
