"""Growing a network: unordered photographs of a camera known by EXIF alone, with false codes and without overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from app.geometry.similarity import estimate_similarity
from app.photogrammetry.growth import Growth, GrowthOptions
from app.photogrammetry.initial_network import grow_networks
from app.photogrammetry.survey import SurveyPhoto, adjust_survey
from app.photogrammetry.survey_input import SurveyInput, read_survey
from tests.photogrammetry.survey_scene import (
    CONTROL_DOTS,
    PLATE,
    Room,
    build_room,
    control_points,
    dot_errors_m,
    ring_of_stations,
    survey_photos,
)

ROOM = build_room()
# A network before its adjustment: photographs of 0.1 px and rays of some metres, under half a centimetre.
STARTED_M = 0.005


def grown(photos: Sequence[SurveyPhoto], focal_factor: float = 1.0) -> tuple[SurveyInput, tuple[Growth, ...]]:
    survey = read_survey(photos, PLATE)
    known = survey.problem.cameras[0]
    intrinsics = known.camera.intrinsics * np.r_[focal_factor, focal_factor, np.ones(7)]
    wrong = replace(known, camera=known.camera.with_intrinsics(intrinsics))
    problem = replace(survey.problem, cameras=(wrong, *survey.problem.cameras[1:]))
    return survey, grow_networks(problem, GrowthOptions(), [].append)


def shape_errors_m(survey: SurveyInput, growth: Growth, room: Room = ROOM) -> np.ndarray:
    """Distances of the decided targets' centres from the truth after the best similarity."""
    decided = np.flatnonzero(growth.decided)
    true_m = np.array([room.poses[int(code)].position_m for code in survey.codes[decided]])
    found_m = growth.network.target_positions_m[decided]
    return np.linalg.norm(estimate_similarity(found_m, true_m).apply(found_m) - true_m, axis=1)


@pytest.mark.parametrize("focal_factor", [0.95, 1.0, 1.05])
def test_all_photographs_stand_whatever_exif_says(focal_factor: float) -> None:
    photos = survey_photos(ROOM, ring_of_stations(12))
    rng = np.random.default_rng(6)
    survey, networks = grown([photos[place] for place in rng.permutation(len(photos))], focal_factor)
    assert len(networks) == 1
    assert networks[0].oriented.all()
    assert shape_errors_m(survey, networks[0]).max() < STARTED_M


def with_false_codes(photos: Sequence[SurveyPhoto], seed: int) -> list[SurveyPhoto]:
    """In every photograph one target in eight carries the code of one that is not in it."""
    rng = np.random.default_rng(seed)
    spoilt = []
    for photo in photos:
        targets = list(photo.detection.targets)
        absent = sorted(set(ROOM.poses) - {target.code for target in targets})
        for place in rng.choice(len(targets), max(1, len(targets) // 8), replace=False):
            targets[place] = replace(targets[place], code=int(absent.pop(rng.integers(len(absent)))))
        spoilt.append(replace(photo, detection=replace(photo.detection, targets=tuple(targets))))
    return spoilt


@pytest.mark.parametrize("seed", range(3))
def test_false_codes_do_not_mislead_the_network(seed: int) -> None:
    survey, networks = grown(with_false_codes(survey_photos(ROOM, ring_of_stations(24)), seed))
    assert networks[0].oriented.all()
    # Near enough for the adjustment, which then sorts the false sightings out.
    assert np.median(shape_errors_m(survey, networks[0])) < 0.05


def test_false_codes_are_sorted_out() -> None:
    photos = with_false_codes(survey_photos(ROOM, ring_of_stations(24)), 0)
    result = adjust_survey(photos, control_points(ROOM, CONTROL_DOTS), PLATE)
    assert not result.unoriented
    assert np.abs(dot_errors_m(ROOM, result.target_map.targets)).max() < 0.004


def test_two_parts_without_common_targets_are_two_networks() -> None:
    near, far = build_room(seed=1), build_room(seed=5)
    far = Room({code + 100: pose for code, pose in far.poses.items()}, {c + 100: p for c, p in far.plates_m.items()})
    photos = survey_photos(near, ring_of_stations(10)) + survey_photos(far, ring_of_stations(7), first=10)
    _, networks = grown(photos)
    assert sorted(int(network.oriented.sum()) for network in networks) == [7, 10]
    assert not (networks[0].oriented & networks[1].oriented).any()


def test_a_photograph_without_common_targets_stays_out() -> None:
    photos = survey_photos(ROOM, ring_of_stations(10))
    strange = [replace(target, code=target.code + 500) for target in photos[3].detection.targets]
    photos[3] = replace(photos[3], detection=replace(photos[3].detection, targets=tuple(strange)))
    survey, networks = grown(photos)
    assert len(networks) == 1
    assert [survey.names[photo] for photo in np.flatnonzero(~networks[0].oriented)] == ["photo03.jpg"]


def test_growing_tells_how_far_it_is_and_may_be_stopped() -> None:
    survey = read_survey(survey_photos(ROOM, ring_of_stations(6)), PLATE)
    told: list[int] = []
    grow_networks(survey.problem, GrowthOptions(), told.append)
    assert told == sorted(told)
    assert told[-1] == 6

    def stop(oriented: int) -> None:
        raise InterruptedError(oriented)

    with pytest.raises(InterruptedError):
        grow_networks(survey.problem, GrowthOptions(), stop)
