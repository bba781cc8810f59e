import numpy as np
import pytest

from app.planning.posting import RoomOptions
from app.planning.room import box_panels, build_room
from app.targets.family import family_by_name

GOLAY = family_by_name("golay")


def test_walls_floor_and_ceiling_look_into_the_room_and_close_it() -> None:
    options = RoomOptions(size_m=(5.0, 4.0, 2.6), targets=4, furniture=False)
    panels = build_room(options, GOLAY, seed=1).panels
    assert len(panels) == 6
    middle_m = np.array(options.size_m) / 2
    for panel in panels:
        assert panel.site_from_panel.inverse().apply(middle_m)[2] > 0
        corners_m = panel.corners_m()
        assert (np.isclose(corners_m, 0.0) | np.isclose(corners_m, options.size_m)).all()
    area_m2 = sum(panel.width_m * panel.height_m for panel in panels)
    assert area_m2 == pytest.approx(2 * (5.0 * 4.0 + 5.0 * 2.6 + 4.0 * 2.6))


def test_the_same_seed_builds_the_same_room() -> None:
    first, again, other = (build_room(RoomOptions(targets=5), GOLAY, seed) for seed in (1, 1, 2))
    for one, same in zip(first.targets, again.targets, strict=True):
        assert one.code == same.code
        np.testing.assert_array_equal(one.dots_m(), same.dots_m())
    assert [target.code for target in first.targets] != [target.code for target in other.targets]


def test_faces_of_a_box_look_outwards_and_meet() -> None:
    centre_m, size_m = np.array([1.0, 2.0, 0.5]), (0.4, 0.6, 1.0)
    for panel in box_panels(centre_m, size_m, (9, 9, 9)):
        assert panel.site_from_panel.inverse().apply(centre_m)[2] < 0
        assert np.allclose(np.abs(panel.corners_m() - centre_m), np.array(size_m) / 2)
