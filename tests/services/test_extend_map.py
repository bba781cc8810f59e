"""Extending a map: its datum and targets stand, new ones come, moved ones are found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import SurveyFailed
from app.geometry.control import ControlPoint
from app.geometry.observations import Detection, TargetObservation
from app.geometry.pose import Pose
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.services.extend_map import ExtendOptions, anchored_points, anchors_of, extend_map
from app.targets.layout import dots_target_m

SIGMA_M = 0.0005
OPTIONS = ExtendOptions()


def target(code: int, position_m: np.ndarray) -> MappedTarget:
    pose = Pose(np.eye(3), np.asarray(position_m, dtype=np.float64))
    return MappedTarget(code, pose, pose.apply(dots_target_m(0.014)), np.eye(6) * SIGMA_M**2, 5, 0.1)


def a_map(places_m: dict[int, np.ndarray], datum_sigma: float = 1e-3) -> TargetMap:
    datum = Datum(np.zeros(3), np.eye(7) * datum_sigma**2)
    return TargetMap(tuple(target(code, place) for code, place in places_m.items()), datum, "golay", 0.014)


def seen(*codes: int) -> Detection:
    observations = (
        TargetObservation(code, np.zeros((16, 2)), np.tile(np.eye(2), (16, 1, 1)), np.ones(16, dtype=np.bool_))
        for code in codes
    )
    return Detection(640, 480, tuple(observations))


PLACES_M = {code: np.random.default_rng(code).uniform(0, 10, 3) for code in range(1, 41)}


def test_anchors_are_common_targets_that_stand_far_apart() -> None:
    base = a_map(PLACES_M)
    shown = [seen(*range(5, 60))] * 3 + [seen(1, 2, 3)]
    anchors = anchors_of(base, shown)
    assert len(anchors) == OPTIONS.most_anchors
    assert {anchor.code for anchor in anchors} <= set(range(5, 41))
    for anchor in anchors:
        np.testing.assert_array_equal(anchor.position_m, PLACES_M[anchor.code])
        assert (anchor.role, anchor.cell) == ("control", None)
        assert anchor.sigma_m == pytest.approx(SIGMA_M)
    apart_m = [
        np.linalg.norm(first.position_m - second.position_m)
        for index, first in enumerate(anchors)
        for second in anchors[:index]
    ]
    taken = {anchor.code for anchor in anchors}
    left = [PLACES_M[code] for code in range(5, 41) if code not in taken]
    nearest_m = [min(np.linalg.norm(place - anchor.position_m) for anchor in anchors) for place in left]
    assert max(nearest_m) <= min(apart_m)  # whoever is left stands nearer than the anchors stand to each other


def test_a_survey_of_another_place_is_refused() -> None:
    with pytest.raises(SurveyFailed, match="Only 2 targets") as refused:
        anchors_of(a_map(PLACES_M), [seen(1, 2, 100)] * 3 + [seen(3)])
    assert refused.value.fields["reason"] == "no-common-targets"


def test_the_sites_own_points_only_check() -> None:
    anchors = anchors_of(a_map(PLACES_M), [seen(1, 2, 3)] * 3)
    own = [
        ControlPoint("CP1", 9, "A", np.ones(3), 0.001, "control"),
        ControlPoint("CP2", anchors[0].code, "centre", np.ones(3), 0.001, "control"),
    ]
    points = anchored_points(anchors, own)
    assert [(point.name, point.role) for point in points[3:]] == [("CP1", "check")]
    assert points[:3] == anchors


def test_the_base_stands_and_new_targets_come_with_the_ties_uncertainty() -> None:
    base, survey = a_map({1: np.zeros(3), 2: np.ones(3)}), a_map({2: np.ones(3) + SIGMA_M, 7: np.full(3, 2.0)}, 2e-3)
    extension = extend_map(base, survey, ())
    assert (extension.added, extension.moved) == ((7,), ())
    assert extension.target_map.datum is base.datum
    assert extension.target_map.by_code[1] is base.by_code[1]
    assert extension.target_map.by_code[2] is base.by_code[2]
    new = extension.target_map.by_code[7]
    np.testing.assert_array_equal(new.dots_m, survey.by_code[7].dots_m)
    expected = survey.by_code[7].covariance + survey.datum.pose_covariance(np.full(3, 2.0))
    np.testing.assert_allclose(new.covariance, expected)


@pytest.mark.parametrize(
    ("step_m", "moved"), [(0.05, True), (OPTIONS.moved_m * 0.9, False), (SIGMA_M, False), (0.0, False)]
)
def test_a_target_in_another_place_was_moved(step_m: float, moved: bool) -> None:
    survey = a_map({1: np.array([step_m, 0.0, 0.0])}, datum_sigma=1e-5)
    extension = extend_map(a_map({1: np.zeros(3)}), survey, ())
    assert extension.moved == ((1,) if moved else ())
    assert extension.target_map.by_code[1].site_from_target.position_m[0] == (step_m if moved else 0.0)


def test_an_uncertain_step_is_no_move() -> None:
    far = a_map({1: np.array([0.05, 0.0, 0.0])}, datum_sigma=0.02)
    assert extend_map(a_map({1: np.zeros(3)}), far, ()).moved == ()


def test_excluded_codes_leave_the_map() -> None:
    base = a_map({1: np.zeros(3), 2: np.ones(3)})
    extension = extend_map(base, replace(base, targets=base.targets[1:]), (1,))
    assert list(extension.target_map.by_code) == [2]
