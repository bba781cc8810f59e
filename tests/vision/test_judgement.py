from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from app.targets.layout import DIGIT_CELLS
from app.vision.centres import DotCentres, locate_dots, refine_homographies
from app.vision.homography import PLATE_DOTS_U, apply_homographies, fit_homographies
from app.vision.inks import BASE, DIGITS, InkReading, read_inks
from app.vision.judgement import (
    COLOUR_REASONS,
    REASON_TEXT,
    Judgement,
    judge_plates,
    misfit_px,
    one_dot_one_target,
)
from app.vision.measurement import PlateFits, SizedPatches
from app.vision.patches import Pyramid
from tests.vision.scenes import Shot, true_homographies

SPOILT = 3  # the plate that a test spoils


@dataclass(frozen=True)
class Measured:
    fits: PlateFits
    inks: InkReading
    dots: DotCentres

    def judged(self) -> Judgement:
        refined = refine_homographies(self.fits, self.dots)
        return judge_plates(self.fits, self.dots, self.inks, refined)


@pytest.fixture(scope="module")
def measured(plates_shot: Shot) -> Measured:
    fits = SizedPatches.of(Pyramid.of(plates_shot.bgr, 1), true_homographies(plates_shot)).fit(0.9)
    inks = read_inks(fits.amplitudes)
    return Measured(fits, inks, locate_dots(fits, inks, (640, 480)))


def with_fits(measured: Measured, **spoilt: np.ndarray) -> Measured:
    fits = replace(measured.fits, **{name: np.array(values) for name, values in spoilt.items()})
    return replace(measured, fits=fits, inks=read_inks(fits.amplitudes))


def dim(measured: Measured) -> Measured:
    amplitudes = measured.fits.amplitudes.copy()
    amplitudes[SPOILT] *= 0.01
    return with_fits(measured, amplitudes=amplitudes)


def orange(measured: Measured) -> Measured:
    amplitudes = measured.fits.amplitudes.copy()
    amplitudes[SPOILT, BASE, 1] = 0.7 * amplitudes[SPOILT, BASE, 2]
    return with_fits(measured, amplitudes=amplitudes)


def noisy(measured: Measured) -> Measured:
    residual_rms = measured.fits.residual_rms.copy()
    residual_rms[SPOILT] = measured.fits.amplitudes[SPOILT, BASE, 2].mean()
    return with_fits(measured, residual_rms=residual_rms)


def patchy(measured: Measured) -> Measured:
    # No plane takes A and C up and B and D down.
    amplitudes = measured.fits.amplitudes.copy()
    amplitudes[SPOILT, BASE] *= np.array([3.8, 0.6, 3.8, 0.6, 0.6])[:, None]
    return with_fits(measured, amplitudes=amplitudes)


def washed_out(measured: Measured) -> Measured:
    planes = measured.fits.planes.copy()
    planes[SPOILT, :, 0] += 3.0 * measured.fits.amplitudes[SPOILT, BASE, 2].mean()
    return with_fits(measured, planes=planes)


def on_green_ground(measured: Measured) -> Measured:
    amplitudes = measured.fits.amplitudes.copy()
    amplitudes[SPOILT, BASE, 1] = -1.2 * amplitudes[SPOILT, BASE, 2]
    return with_fits(measured, amplitudes=amplitudes)


def with_a_red_digit(measured: Measured) -> Measured:
    amplitudes = measured.fits.amplitudes.copy()
    amplitudes[SPOILT, DIGIT_CELLS[3]] = amplitudes[SPOILT, BASE].mean(axis=0)
    return with_fits(measured, amplitudes=amplitudes)


def unlike(measured: Measured) -> Measured:
    spread_rms = measured.fits.spread_rms.copy()
    spread_rms[SPOILT] = 1.5 * measured.fits.residual_rms[SPOILT]
    return with_fits(measured, spread_rms=spread_rms)


def with_dots(measured: Measured, name: str, change: Callable[[np.ndarray], None]) -> Measured:
    values = getattr(measured.dots, name).copy()
    change(values[SPOILT])
    return replace(measured, dots=replace(measured.dots, **{name: values}))


def cut_off(measured: Measured) -> Measured:
    def change(inside: np.ndarray) -> None:
        inside[BASE[:2]] = False

    return with_dots(measured, "inside", change)


def sparse(measured: Measured) -> Measured:
    def change(seen: np.ndarray) -> None:
        seen[DIGITS] = False

    return with_dots(measured, "measured", change)


def crooked(measured: Measured) -> Measured:
    def change(centres_px: np.ndarray) -> None:
        centres_px += np.random.default_rng(1).normal(0.0, 1.5, centres_px.shape)  # of plates of 4 px per u

    return with_dots(measured, "centres_px", change)


def test_plates_stand(measured: Measured) -> None:
    judgement = measured.judged()
    assert judgement.stands.all() and set(judgement.reasons) == {""}
    assert judgement.rms_px.max() < 0.1
    assert not judgement.lacks_red.any()


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (dim, "not-red"),
        (orange, "not-red"),
        (noisy, "not-red"),
        (patchy, "uneven-red"),
        (washed_out, "bright-background"),
        (on_green_ground, "bright-background"),
        (with_a_red_digit, "red-digit"),
        (unlike, "not-a-plate"),
        (cut_off, "outside-photo"),
        (sparse, "too-few-dots"),
        (crooked, "wrong-layout"),
    ],
)
def test_each_fault_is_named_and_refuses_one_plate_alone(
    measured: Measured, spoil: Callable[[Measured], Measured], reason: str
) -> None:
    reasons = list(spoil(measured).judged().reasons)
    assert reasons.pop(SPOILT) == reason and reason in REASON_TEXT
    assert set(reasons) == {""}


def test_a_faint_base_dot_lacks_red_and_one_alone_refuses_no_plate(measured: Measured) -> None:
    amplitudes = measured.fits.amplitudes.copy()
    amplitudes[SPOILT, BASE[2]] *= 0.1
    spoilt = with_fits(measured, amplitudes=amplitudes)
    expected = np.zeros((24, 5), dtype=bool)
    expected[SPOILT, 2] = True
    judgement = spoilt.judged()
    np.testing.assert_array_equal(judgement.lacks_red, expected)
    assert judgement.stands.all()
    amplitudes[SPOILT, BASE[0]] *= 0.1
    assert with_fits(measured, amplitudes=amplitudes).judged().reasons[SPOILT] == "not-red"


def test_every_reason_is_explained() -> None:
    assert set(COLOUR_REASONS) < set(REASON_TEXT)
    assert all(text and text[0].islower() for text in REASON_TEXT.values())


def test_a_later_refusal_changes_no_other_verdict() -> None:
    judgement = Judgement(("", "not-red", "", ""), np.arange(4.0), np.zeros((4, 5), dtype=bool))
    refused = judgement.refuse(np.array([2, 3]), "base-dot-missing")
    assert refused.reasons == ("", "not-red", "base-dot-missing", "base-dot-missing")
    assert refused.stands.tolist() == [True, False, False, False]
    np.testing.assert_array_equal(refused.rms_px, judgement.rms_px)
    assert judgement.refuse(np.array([], dtype=int), "wrong-layout") == judgement


def test_the_misfit_is_the_scatter_per_coordinate(measured: Measured) -> None:
    homographies, rng, sigma_px = measured.fits.image_from_plate, np.random.default_rng(2), 0.3
    centres_px = apply_homographies(homographies, PLATE_DOTS_U) + rng.normal(0.0, sigma_px, (24, 16, 2))
    everything = np.ones((24, 16), dtype=bool)
    dots = replace(measured.dots, centres_px=centres_px, measured=everything)
    misfits_px = misfit_px(dots, fit_homographies(PLATE_DOTS_U, centres_px, np.ones((24, 16))))
    # 24 of 32 coordinates are left to disagree on each of 24 plates.
    assert np.sqrt((misfits_px**2).mean()) == pytest.approx(sigma_px, rel=3 / np.sqrt(2 * 24 * 24))


def test_a_plate_of_four_dots_cannot_disagree(measured: Measured) -> None:
    four = np.zeros((24, 16), dtype=bool)
    four[:, BASE[:4]] = True
    dots = replace(measured.dots, measured=four)
    assert np.isfinite(misfit_px(dots, measured.fits.image_from_plate)).all()


def test_a_dot_belongs_to_the_best_group_that_wants_it() -> None:
    groups = np.array([[0, 1, 2, 3, 4], [4, 5, 6, 7, 8], [5, 6, 7, 8, 9], [10, 11, 12, 13, 14]])
    assert one_dot_one_target(groups, np.array([0.5, 0.9, 0.7, 0.1])).tolist() == [1, 3]
    assert one_dot_one_target(groups, np.array([0.9, 0.5, 0.7, 0.1])).tolist() == [0, 2, 3]
    assert one_dot_one_target(groups[:0], np.array([])).shape == (0,)


def test_dots_that_nobody_saw_are_shared() -> None:
    groups = np.array([[0, 1, 2, 3, -1], [4, 5, 6, 7, -1]])
    assert one_dot_one_target(groups, np.array([0.5, 0.6])).tolist() == [1, 0]
