"""Deformed plates: stretch and bend found as they were put in."""

from __future__ import annotations

import numpy as np
import pytest

from app.photogrammetry.plate_faults import PlateFits, fit_plates
from app.photogrammetry.quality import QualityOptions, fault_of_plate
from app.photogrammetry.robust import RobustLoss
from app.targets.layout import dots_target_m
from tests.photogrammetry.survey_scene import U_M, Room, build_room, ring_of_stations
from tests.photogrammetry.true_network import see

ROOM = build_room()
STATIONS = ring_of_stations(16)
LOSS = RobustLoss("huber", 1e6)


def fits_of(room: Room, noise_px: float = 0.0) -> PlateFits:
    truth = see(room, STATIONS, noise_px)
    return fit_plates(truth.problem, truth.network, LOSS)


def test_a_stretch_is_found() -> None:
    fits = fits_of(ROOM.with_plate(109, dots_target_m(U_M, (1.01, 0.995))))
    np.testing.assert_allclose(fits.stretch[8], [0.01, -0.005], atol=1e-4)  # linear: the square of a percent
    np.testing.assert_allclose(np.delete(fits.stretch, 8, axis=0), 0.0, atol=1e-6)


def test_a_bend_is_found() -> None:
    plate_m = dots_target_m(U_M)
    plate_m[:, 2] = 0.003 * plate_m[:, 0] * plate_m[:, 1] / plate_m[:, 0].max() ** 2
    fits = fits_of(ROOM.with_plate(109, plate_m))
    assert fits.bend_m[8] == pytest.approx(np.sqrt(np.mean(plate_m[:, 2] ** 2)), rel=0.01)
    assert fits.gain[8] > QualityOptions().fault_gain
    assert np.delete(fits.bend_m, 8).max() < 1e-6


def test_good_plates_gain_what_chance_gives() -> None:
    fits = fits_of(ROOM, noise_px=0.1)
    gains = fits.gain
    # Chi-square of five degrees: a mean of 5, a deviation of sqrt(10); four standard errors.
    assert abs(gains.mean() - 5.0) < 4.0 * np.sqrt(10.0 / len(gains))
    assert not any(fault_of_plate(fits, U_M, 1.0, QualityOptions()))


def test_what_all_plates_share_is_no_fault() -> None:
    room = build_room(scale_xy=(1.01, 0.99))
    words = fault_of_plate(fits_of(room), U_M, 1.0, QualityOptions())
    assert not any(words)
