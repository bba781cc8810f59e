"""The survey benchmark in little: a sound survey of a building raises no alarm, a fault in it is named."""

from __future__ import annotations

import numpy as np
import pytest

from app.photogrammetry.survey import PlateSpec, SurveyResult, adjust_survey
from benchmarks.building import FAMILY, BuildingOptions, build_building
from benchmarks.building_views import U_M, ViewOptions, photograph, spread_control
from benchmarks.map_score import score_map
from benchmarks.survey_faults import Sound, misread
from benchmarks.survey_run import BUILDINGS, named_faults, true_dots_m
from benchmarks.survey_scale import growth_exponent

SEED = 1
SMALL = BuildingOptions(wings=1, bays=1)


@pytest.fixture(scope="module")
def sound() -> Sound:
    building = build_building(SMALL, SEED)
    control = spread_control(building, (6, 2), 0.001, SEED)
    return Sound(SMALL, building, photograph(building, ViewOptions(), SEED), control, SEED)


def adjusted(sound: Sound) -> SurveyResult:
    return adjust_survey(sound.photos, sound.control, PlateSpec(FAMILY, U_M))


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.3])
def test_the_exponent_of_a_power_law_is_found(exponent: float) -> None:
    sizes = [54.0, 500.0, 5000.0]
    assert growth_exponent(sizes, [3.0 * size**exponent for size in sizes]) == pytest.approx(exponent)


def test_buildings_have_two_plates_to_a_photograph() -> None:
    for photos in (54, 500):
        building = build_building(BUILDINGS[photos], SEED)
        assert len(building.stations) == photos
        assert len(building.plates) == pytest.approx(2 * photos, rel=0.1)


def test_nobody_sees_through_walls(sound: Sound) -> None:
    rooms = {code: pose.position_m for code, pose in sound.building.plates.items()}
    for photo, station in zip(sound.photos, sound.building.stations, strict=True):
        for seen in photo.detection.targets:
            sight_m = rooms[seen.code][:2] - station.position_m[:2]
            for wall_m in sound.building.walls_m:
                along_m = wall_m[1] - wall_m[0]
                sides = np.linalg.det(np.stack([sight_m, wall_m[0] - station.position_m[:2]]))
                others = np.linalg.det(np.stack([sight_m, wall_m[1] - station.position_m[:2]]))
                before = np.linalg.det(np.stack([along_m, station.position_m[:2] - wall_m[0]]))
                after = np.linalg.det(np.stack([along_m, rooms[seen.code][:2] - wall_m[0]]))
                assert sides * others > 0 or before * after > 0


def test_a_sound_survey_raises_no_alarm_and_knows_its_errors(sound: Sound) -> None:
    result = adjusted(sound)
    assert named_faults(result) == 0
    score = score_map(result.target_map, true_dots_m(sound.building), sound.control)
    # Six expected; about a hundred targets share a dozen photographs each way, which leaves some tenths of scatter.
    assert 3.0 < score.target_nees < 12.0


def test_misread_codes_are_named(sound: Sound) -> None:
    faulty = misread(0.01)(sound, np.random.default_rng(SEED))
    assert faulty.sightings
    result = adjust_survey(faulty.photos, faulty.control, PlateSpec(FAMILY, U_M))
    said = {(record.photo, record.code) for record in result.report.false_sightings}
    published = result.target_map.by_code
    assert all((photo, code) in said or code not in published for photo, code in faulty.sightings)
