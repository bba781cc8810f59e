"""Print batches of a survey: measured ones are used, those that nobody listed are found, named and mapped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.geometry.print_batch import PrintBatch
from app.photogrammetry.prints import PRINT_SIGMA, Prints, one_batch
from app.photogrammetry.survey import PlateSpec, SurveyResult, adjust_survey
from app.targets.layout import dots_target_m
from tests.photogrammetry.survey_scene import (
    CONTROL_DOTS,
    U_M,
    Room,
    build_room,
    control_points,
    ring_of_stations,
    survey_photos,
)

ROOM = build_room()
STATIONS = ring_of_stations(16)
SCALE = (0.97, 0.968)


def resized(codes: tuple[int, ...], scale: tuple[float, float]) -> Room:
    room = ROOM
    for code in codes:
        room = room.with_plate(code, dots_target_m(U_M, scale))
    return room


def codes_of_a_batch() -> tuple[int, ...]:
    """Every third target, but those with a control point."""
    taken = {point.code for point in control_points(ROOM, CONTROL_DOTS)}
    return tuple(code for code in sorted(ROOM.poses)[::3] if code not in taken)


def surveyed(room: Room, batches: tuple[PrintBatch, ...] = (), with_control: bool = True) -> SurveyResult:
    points = control_points(ROOM, CONTROL_DOTS) if with_control else ()
    return adjust_survey(survey_photos(room, STATIONS), points, PlateSpec("golay", U_M, batches))


def errors_m(result: SurveyResult) -> np.ndarray:
    return np.array(
        [
            target.site_from_target.position_m - ROOM.poses[target.code].position_m
            for target in result.target_map.targets
        ]
    )


def test_a_batch_that_nobody_listed_is_found_and_mapped() -> None:
    codes = codes_of_a_batch()
    result = surveyed(resized(codes, SCALE))
    (found,) = [batch for batch in result.report.print_batches if batch.found]
    assert set(found.codes) <= set(codes)
    assert len(found.codes) >= 0.9 * len(codes)
    assert (np.abs(found.scale - SCALE) < 5.0 * found.sigmas).all()
    assert any("measure the check bars" in warning for warning in result.report.warnings)
    assert not result.report.left_out
    sound = surveyed(ROOM)
    assert np.sqrt((errors_m(result) ** 2).mean()) < 1.5 * np.sqrt((errors_m(sound) ** 2).mean())


def test_measured_bars_are_used_and_no_batch_is_found() -> None:
    codes = codes_of_a_batch()
    listed = PrintBatch("fitted to the page", codes, 97.0, 96.8, 0.1)
    result = surveyed(resized(codes, SCALE), (listed,))
    rest, batch = result.report.print_batches
    assert (rest.name, batch.name, batch.codes) == ("", listed.name, codes)
    assert not any("batch" in warning for warning in result.report.warnings)
    target = next(target for target in result.target_map.targets if target.code == codes[0])
    side_m = np.linalg.norm(target.dots_m[3] - target.dots_m[0])
    assert side_m == pytest.approx(9.0 * U_M * SCALE[0], rel=5e-4)


def test_without_control_the_best_measured_batch_gives_the_scale() -> None:
    scale = 1.01
    every = tuple(sorted(ROOM.poses))
    room = resized(every, (scale, scale))
    result = surveyed(room, (PrintBatch("all", every, 100.0 * scale, 100.0 * scale, 0.05),), with_control=False)
    places_m = np.array([target.site_from_target.position_m for target in result.target_map.targets])
    true_m = np.array([ROOM.poses[target.code].position_m for target in result.target_map.targets])
    spread = [np.sqrt(((p - p.mean(axis=0)) ** 2).sum()) for p in (places_m, true_m)]
    assert spread[0] / spread[1] == pytest.approx(1.0, abs=5e-4)
    assert np.sqrt(result.target_map.datum.covariance[6, 6]) < PRINT_SIGMA / 2.0


def test_wrongly_measured_bars_are_doubted() -> None:
    codes = codes_of_a_batch()
    result = surveyed(ROOM, (PrintBatch("mixed up", codes, 98.5, 98.5, 0.1),))
    assert any("mixed up" in warning and "measure them again" in warning for warning in result.report.warnings)


def test_the_best_known_batch_has_enough_targets() -> None:
    prints = Prints(
        np.array([0, 0, 0, 0, 1, 1, 1, 2]),
        np.array([0, 0, 0, 0, 1, 1, 1, 2]),
        np.ones((3, 2)),
        np.array([0.002, 0.001, 0.0001]),
        held=np.ones(3, dtype=np.bool_),
        found=np.zeros(3, dtype=np.bool_),
    )
    assert prints.best_known(3) == 1
    assert prints.best_known(5) == 0
    assert list(prints.freed().held_at(1).held) == [False, True, False]


def test_prints_are_checked_at_birth() -> None:
    with pytest.raises(ValueError, match="positive"):
        one_batch(3, 0.0)
    with pytest.raises(ValueError, match="ascend"):
        PrintBatch("a", (2, 1), 100.0, 100.0, 0.1)
    good = PrintBatch("a", (1, 2), 97.0, 99.0, 0.2)
    assert (good.scale_xy, good.scale_sigma) == ((0.97, 0.99), 0.002)
    with pytest.raises(ValueError, match="positive"):
        replace(good, sigma_mm=0.0)
