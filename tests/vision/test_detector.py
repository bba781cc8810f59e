from dataclasses import replace

import cv2
import numpy as np
import pytest

from app.planning.imaging import ImagingOptions
from app.planning.scene import PostedTarget
from app.planning.survey_plan import small_room
from app.targets.digits import code_of_digits, digits_of_code
from app.targets.drawing import cell_colours_rgb, plate_rgb
from app.targets.family import CodeFamily, family_by_name
from app.targets.layout import BASE_CELLS, DIGIT_CELLS
from app.vision.detector import DetectorOptions, detect
from app.vision.photo import load_photo
from app.vision.reading import Strictness
from tests.vision.scenes import (
    Shot,
    before_wall,
    found,
    photograph,
    photographs,
    plate_at,
    plates_in_rows,
    refused,
    wrong_plate,
)

CONDITIONS = {
    "dim": ImagingOptions(exposure_ev=-3.0, full_well_electrons=800.0),
    "over-exposed": ImagingOptions(exposure_ev=1.3),
    "warm": ImagingOptions(white_balance_rgb=(1.3, 1.0, 0.55)),
    "blurred": ImagingOptions(lens_sigma_px=1.1),
    "defocused": ImagingOptions(defocus_radius_px=1.8),
    "in motion": ImagingOptions(motion_px=(3.0, 1.5)),
    "JPEG 60": ImagingOptions(jpeg_quality=60),
    "sharpened": ImagingOptions(sharpening=0.6, lens_sigma_px=0.5),
    "noisy": ImagingOptions(full_well_electrons=150.0),
}
STRICT, NORMAL, EAGER = (DetectorOptions(strictness=strictness) for strictness in ("strict", "normal", "eager"))


@pytest.fixture(scope="module")
def shots(codes: np.ndarray) -> dict[str, Shot]:
    """24 plates of 3.5 px per u, up to 50 degrees, under all conditions."""
    scene = before_wall(plates_in_rows(codes, (6, 4), 3.5, seed=5, slant_deg=50.0))
    return dict(zip(CONDITIONS, photographs(scene, CONDITIONS.values()), strict=True))


@pytest.mark.parametrize("condition", CONDITIONS)
def test_all_targets_are_found_and_none_is_misread(shots: dict[str, Shot], family: CodeFamily, condition: str) -> None:
    shot = shots[condition]
    detection = detect(shot.bgr, family)
    assert (detection.width_px, detection.height_px) == (640, 480)
    assert set(found(detection)) == shot.whole_codes() and len(shot.truth) == 24
    for target in detection.targets:
        assert target.measured[list(BASE_CELLS)].all()
        # A thirtieth of a radius in the worst light: the right plate, and not one beside it.
        assert np.abs(target.centres_px - shot.dots_px(target.code))[target.measured].max() < 0.5


def test_small_plates_read_well_when_out_of_focus(codes: np.ndarray, family: CodeFamily) -> None:
    """A template too sharp for the picture takes green for black, and one code for another."""
    scene = before_wall(plates_in_rows(codes, (7, 5), 2.5, seed=2))
    shot = photograph(scene, ImagingOptions(defocus_radius_px=2.0))
    read = set(found(detect(shot.bgr, family)))
    assert read <= shot.whole_codes() and len(read) >= 0.9 * len(shot.whole_codes())


@pytest.mark.parametrize("index", [0, 4])  # the fifth is taken upright
def test_a_room_is_read_through_its_files(family: CodeFamily, index: int) -> None:
    photo = small_room(family, seed=1).photograph(index)
    read = set(found(detect(load_photo(photo.jpeg).bgr, family)))
    assert photo.whole_codes() <= read <= {target.code for target in photo.targets} and photo.whole_codes()


def test_a_turned_picture_gives_turned_targets(plates_shot: Shot, family: CodeFamily) -> None:
    upright = found(detect(plates_shot.bgr, family))
    turned = found(detect(np.rot90(plates_shot.bgr), family))
    assert set(turned) == set(upright)
    for code, target in upright.items():
        x, y = target.centres_px.T
        both = target.measured & turned[code].measured
        expected_px = np.stack([y, 639.0 - x], axis=1)
        assert np.abs(turned[code].centres_px - expected_px)[both].max() < 0.1


def test_the_same_photograph_gives_the_same_numbers(plates_shot: Shot, family: CodeFamily) -> None:
    first, again = detect(plates_shot.bgr, family), detect(plates_shot.bgr.copy(), family)
    assert [target.code for target in first.targets] == [target.code for target in again.targets]
    for one, other in zip(first.targets, again.targets, strict=True):
        np.testing.assert_array_equal(one.centres_px, other.centres_px)
        np.testing.assert_array_equal(one.covariances_px2, other.covariances_px2)


@pytest.mark.parametrize("name", ["hamming", "parity", "full"])
def test_other_families_are_read(name: str) -> None:
    other = family_by_name(name)
    codes = np.random.default_rng(3).choice(other.codes, 6, replace=False)
    shot = photograph(before_wall(plates_in_rows(codes, (3, 2), 4.0, seed=6, slant_deg=40.0)), ImagingOptions())
    assert set(found(detect(shot.bgr, other))) == set(codes.tolist())


def misprinted(plate: PostedTarget, wrong_digits: int) -> PostedTarget:
    """The plate with some of its digits printed in another ink."""
    digits = digits_of_code(plate.code)
    digits[:wrong_digits] = (digits[:wrong_digits] + 1) % 3
    return wrong_plate(plate, cell_colours_rgb(code_of_digits(digits)))


@pytest.fixture(scope="module")
def misprints(codes: np.ndarray) -> Shot:
    """Nine plates: three as they should be, three with one wrong digit, three with two."""
    plates = plates_in_rows(codes, (3, 3), 4.0, seed=8, slant_deg=30.0)
    return photograph(
        before_wall(misprinted(plate, index // 3) for index, plate in enumerate(plates)), ImagingOptions()
    )


@pytest.mark.parametrize(("strictness", "mended"), [("strict", 0), ("normal", 1), ("eager", 2)])
def test_strictness_says_how_much_may_be_mended(
    misprints: Shot, family: CodeFamily, strictness: Strictness, mended: int
) -> None:
    site = frozenset(target.code for target in misprints.truth)
    detection = detect(misprints.bgr, family, DetectorOptions(strictness=strictness), site)
    expected = {target.code: index // 3 for index, target in enumerate(misprints.truth) if index // 3 <= mended}
    assert {target.code: target.corrected for target in detection.targets} == expected
    assert refused(detection) == ["code-not-in-family"] * (9 - len(expected))


def test_a_mended_code_must_be_one_that_the_site_holds(misprints: Shot, family: CodeFamily) -> None:
    all_codes = [target.code for target in misprints.truth]
    # Of the site's codes the first whole plate's and the first mended plate's are missing.
    known = frozenset(all_codes) - {all_codes[0], all_codes[3]}
    detection = detect(misprints.bgr, family, NORMAL, known)
    assert set(found(detection)) == set(all_codes[:3]) | set(all_codes[4:6])
    assert set(found(detect(misprints.bgr, family, EAGER, frozenset()))) == set(all_codes[:3])


def mirrored_word(code: int) -> np.ndarray:
    """The digits that a mirror shows, about the diagonal A-C, on which the base dots look the same."""
    cells = np.zeros(16, dtype=np.int8)
    cells[list(DIGIT_CELLS)] = digits_of_code(code)
    return cells.reshape(4, 4).T.ravel()[list(DIGIT_CELLS)]


def test_in_a_mirror_only_words_that_are_codes_both_ways_are_read(plates_shot: Shot, family: CodeFamily) -> None:
    """Five base dots are their own mirror image: only the code tells, and a mended one is none beside its mirror's."""
    exact = [family.decode(mirrored_word(target.code), 0) for target in plates_shot.truth]
    expected = {word.code for word in exact if word is not None}
    assert len(expected) <= 1 and not expected & plates_shot.whole_codes()
    within_one = sum(family.decode(mirrored_word(target.code), 1) is not None for target in plates_shot.truth)
    for options, mirrors in ((STRICT, 0), (NORMAL, within_one - len(expected)), (EAGER, len(plates_shot.truth))):
        detection = detect(plates_shot.bgr[:, ::-1], family, options)
        assert set(found(detection)) == expected
        assert refused(detection).count("mirror-image") == min(mirrors, len(plates_shot.truth) - len(expected))


def test_a_site_s_list_tells_its_plates_from_those_in_a_mirror(plates_shot: Shot, family: CodeFamily) -> None:
    known = frozenset(plates_shot.whole_codes())
    assert set(found(detect(plates_shot.bgr, family, NORMAL, known))) == known
    assert not found(detect(plates_shot.bgr[:, ::-1], family, NORMAL, known))


def test_of_two_plates_with_one_code_one_is_reported_as_its_double(codes: np.ndarray, family: CodeFamily) -> None:
    plates = plates_in_rows(codes, (3, 1), 4.0, seed=9, slant_deg=30.0)
    twice = (plates[0], replace(plates[1], code=plates[0].code), plates[2])
    shot = photograph(before_wall(twice), ImagingOptions())
    detection = detect(shot.bgr, family)
    assert set(found(detection)) == {plates[0].code, plates[2].code}
    (double,) = detection.rejected
    assert (double.reason, double.code) == ("duplicate-code", plates[0].code) and double.detail
    middles = np.stack([target.dots_px.mean(axis=0) for target in shot.truth[:2]])
    kept = found(detection)[plates[0].code].centre_px
    np.testing.assert_allclose(np.sort(np.stack([kept, double.centre_px]), axis=0), np.sort(middles, axis=0), atol=3.0)


def test_plates_that_reach_out_of_the_frame_are_never_misread(codes: np.ndarray, family: CodeFamily) -> None:
    places = [(25.0 * step, 240.0) for step in range(2)] + [(320.0, 20.0), (320.0, 455.0), (610.0, 100.0)]
    plates = [plate_at(place, 5.0, int(code), (0.2, 0.2, 1.0)) for place, code in zip(places[1:], codes, strict=False)]
    shot = photograph(before_wall(plates), ImagingOptions())
    assert not shot.whole_codes() and shot.truth
    detection = detect(shot.bgr, family)
    assert set(found(detection)) <= {target.code for target in shot.truth}
    for target in detection.targets:
        truth = next(seen for seen in shot.truth if seen.code == target.code)
        out = ((truth.dots_px < 0) | (truth.dots_px > [639.0, 479.0])).any(axis=1)
        assert not target.measured[out].any()


def polka_dots() -> np.ndarray:
    """Red dots on black in the plate's own proportions, all over."""
    tile = plate_rgb(389, 4)[..., ::-1].copy()
    red_dot = tile[4:12, 4:12]
    picture = np.zeros((480, 640, 3), dtype=np.uint8)
    for y in range(0, 468, 12):
        for x in range(0, 624, 12):
            picture[y + 2 : y + 10, x + 2 : x + 10] = red_dot
    return picture


def coloured_lamps() -> np.ndarray:
    """A grid of lamps, each in a colour of its own, on black."""
    rng = np.random.default_rng(4)
    picture = np.zeros((480, 640, 3), dtype=np.uint8)
    inks = [(36, 28, 200), (62, 150, 10), (232, 238, 238), (24, 24, 26), (255, 40, 40), (20, 200, 250)]
    for y in range(10, 470, 15):
        for x in range(10, 630, 15):
            cv2.circle(picture, (x, y), 5, inks[int(rng.integers(len(inks)))], -1, cv2.LINE_AA)
    return cv2.GaussianBlur(picture, (0, 0), 0.7)


def red_text() -> np.ndarray:
    picture = np.full((480, 640, 3), 20, dtype=np.uint8)
    for row in range(20, 480, 22):
        cv2.putText(picture, "8o0: oO8 %oo8 ::0 8Oo", (5, row), cv2.FONT_HERSHEY_DUPLEX, 0.8, (30, 30, 210), 2)
    return picture


def noise() -> np.ndarray:
    return np.random.default_rng(5).integers(0, 256, (480, 640, 3), dtype=np.uint8)


def warm_grain() -> np.ndarray:
    grain = np.random.default_rng(6).normal(0.0, 40.0, (480, 640, 3))
    return np.clip(cv2.GaussianBlur(grain, (0, 0), 2.0) * 6.0 + [60.0, 90.0, 170.0], 0, 255).astype(np.uint8)


@pytest.mark.parametrize("draw", [polka_dots, coloured_lamps, red_text, noise, warm_grain])
def test_pictures_without_targets_have_none(family: CodeFamily, draw: object) -> None:
    picture = draw()  # type: ignore[operator]
    assert detect(picture, family).targets == ()
    assert detect(picture, family, EAGER).targets == ()


@pytest.mark.parametrize("size", [(1, 1), (2, 3), (1, 500), (30, 30)])
def test_tiny_pictures_have_no_target(family: CodeFamily, size: tuple[int, int]) -> None:
    detection = detect(np.full((*size, 3), (30, 30, 200), dtype=np.uint8), family)
    assert (detection.height_px, detection.width_px) == size
    assert detection.targets == () and detection.rejected == ()


def test_how_a_picture_lies_in_memory_does_not_matter(shots: dict[str, Shot], family: CodeFamily) -> None:
    bgr = shots["sharpened"].bgr
    strided = np.asfortranarray(bgr)
    strided.flags.writeable = False
    for seen, expected in zip(detect(strided, family).targets, detect(bgr, family).targets, strict=True):
        assert seen.code == expected.code
        np.testing.assert_array_equal(seen.centres_px, expected.centres_px)
