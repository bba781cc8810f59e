from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.planning.imaging import ImagingOptions
from app.planning.scene import Lamp, Scene
from app.targets.digits import digits_of_code
from app.targets.layout import BASE_CELLS, DIGIT_CELLS
from app.vision.homography import PLATE_DOTS_U
from app.vision.inks import BASE, DIGITS, LEVEL_FROM_BASE, InkReading, read_inks
from app.vision.kernels.inkwell import GREEN, HIDDEN_DIGIT, RED
from app.vision.measurement import fit_patches
from app.vision.patches import Pyramid, take_patches
from app.vision.reading import ReadingOptions
from app.vision.template import PatchGrid
from tests.vision.scenes import Shot, photograph, photographs, true_homographies

# Blue, green, red of printed inks over red's red, in linear light and even illumination.
INKS = {0: (0.0, 0.0, 0.0), 1: (0.06, 0.5, 0.0), 2: (1.4, 1.5, 1.5)}
RED_INK = (0.02, 0.01, 1.0)
CODE = 389


def amplitudes_of(code: int, level: float = 100.0) -> np.ndarray:
    """What a template fit of an ideal plate finds, shape (1, 16, 3)."""
    amplitudes = np.empty((1, 16, 3))
    amplitudes[:, BASE] = RED_INK
    amplitudes[:, DIGITS] = [INKS[digit] for digit in digits_of_code(code).tolist()]
    return level * amplitudes


def read(shot: Shot, blur_px: float = 0.75) -> InkReading:
    homographies = true_homographies(shot)
    patches = take_patches(Pyramid.of(shot.bgr, 1), homographies, PatchGrid.FINE)
    return read_inks(fit_patches(patches, np.full(len(homographies), blur_px)).amplitudes)


@given(code=st.integers(1, 177_146), level=st.floats(3.0, 300.0))
def test_printed_inks_are_read_at_any_brightness(code: int, level: float) -> None:
    reading = read_inks(amplitudes_of(code, level))
    np.testing.assert_array_equal(reading.digits[0], digits_of_code(code))
    assert (reading.confidence > 0.9).all()
    np.testing.assert_allclose(reading.red_level, level)
    assert reading.red_base.all()
    coloured = np.ones(16, dtype=bool)
    coloured[DIGITS] = digits_of_code(code) > 0
    np.testing.assert_array_equal(reading.coloured[0], coloured)


@given(code=st.integers(1, 177_146), slope=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)))
def test_light_that_changes_over_the_plate_is_followed(code: int, slope: tuple[float, float]) -> None:
    light = 1.0 + PLATE_DOTS_U @ slope / 4.5 / 1.5
    reading = read_inks(amplitudes_of(code) * light[:, None])
    np.testing.assert_array_equal(reading.digits[0], digits_of_code(code))
    inner = [5, 6, 9, 10]
    np.testing.assert_allclose(reading.red_level[0, inner], 100.0 * light[inner])


def test_levels_of_a_plane_are_extended_exactly() -> None:
    plane = 3.0 + PLATE_DOTS_U @ [0.2, -0.5]
    np.testing.assert_allclose(LEVEL_FROM_BASE @ plane[BASE], plane)


def with_stray_light(amplitudes: np.ndarray, share: float) -> np.ndarray:
    """What a fit under too soft a template finds: of each dot a part in those beside it, and less in those aslant."""
    row, column = np.divmod(np.arange(16), 4)
    down, along = np.abs(row[:, None] - row), np.abs(column[:, None] - column)
    beside, aslant = down + along == 1, (down == 1) & (along == 1)
    return amplitudes + share * np.einsum("do,poc->pdc", beside + 0.3 * aslant, amplitudes)


@given(
    code=st.integers(1, 177_146),
    turn=st.floats(0.0, 6.3),
    edge_u=st.floats(-3.0, 3.0),
    left=st.floats(0.2, 0.35),
    share=st.floats(0.0, 0.08),
)
def test_stray_light_makes_no_digit_in_a_shadow(
    code: int, turn: float, edge_u: float, left: float, share: float
) -> None:
    """A few per cent of a lit white dot are brighter than green in the shadow: hidden perhaps, but never misread."""
    inward_u = PLATE_DOTS_U @ [np.cos(turn), np.sin(turn)] - edge_u
    light = np.where(inward_u > 0.0, left, 1.0)
    reading = read_inks(with_stray_light(amplitudes_of(code) * light[:, None], share))
    sure = (reading.digits[0] != HIDDEN_DIGIT) & (reading.confidence[0] > ReadingOptions().confidence_min)
    np.testing.assert_array_equal(reading.digits[0, sure], digits_of_code(code)[sure])
    if share == 0.0:
        assert sure.all()


@pytest.mark.parametrize("gains", [(0.5, 0.8, 1.2), (1.5, 1.1, 0.8), (1.0, 0.7, 1.0)])
def test_a_cast_flips_no_digit(gains: tuple[float, float, float]) -> None:
    code = 88_753
    reading = read_inks(amplitudes_of(code) * gains)
    np.testing.assert_array_equal(reading.digits[0], digits_of_code(code))


def test_confidence_falls_to_nothing_at_the_border_between_two_inks() -> None:
    amplitudes = np.repeat(amplitudes_of(0), 101, axis=0)
    share = np.linspace(0.0, 1.0, 101)
    amplitudes[:, DIGITS[3]] = 100.0 * share[:, None] * INKS[1]
    reading = read_inks(amplitudes)
    digits, confidence = reading.digits[:, 3], reading.confidence[:, 3]
    border = int(np.flatnonzero(np.diff(digits))[0])
    assert digits[0] == 0 and digits[-1] == 1 and len(np.flatnonzero(np.diff(digits))) == 1
    assert confidence[border : border + 2].max() < 0.05
    assert (np.diff(confidence[: border + 1]) < 0).all() and (np.diff(confidence[border + 1 :]) >= 0).all()


@pytest.mark.parametrize(
    "bgr", [RED_INK, (0.0, 0.2, 1.0), (15.0, 15.0, 15.0), (-2.0, -2.0, -2.0)], ids=["red", "skin", "lamp", "shadow"]
)
def test_what_is_no_ink_is_hidden(bgr: tuple[float, float, float]) -> None:
    amplitudes = amplitudes_of(CODE)
    amplitudes[0, DIGITS[4]] = 100.0 * np.array(bgr)
    reading = read_inks(amplitudes)
    assert reading.digits[0, 4] == HIDDEN_DIGIT and not reading.coloured[0, DIGITS[4]]
    rest = np.arange(11) != 4
    np.testing.assert_array_equal(reading.digits[0, rest], digits_of_code(CODE)[rest])


@pytest.mark.parametrize("bgr", [(0.1, 0.15, 0.2), (0.0, 0.0, 0.0), (1.4, 1.5, 1.5), (0.06, 0.5, 0.0)])
@pytest.mark.parametrize("role", range(5))
def test_a_base_dot_that_is_not_red_has_no_say_in_the_level(role: int, bgr: tuple[float, float, float]) -> None:
    amplitudes = amplitudes_of(CODE)
    amplitudes[0, BASE_CELLS[role]] = 100.0 * np.array(bgr)
    reading = read_inks(amplitudes)
    assert reading.red_base[0].tolist() == [other != role for other in range(5)]
    assert not reading.coloured[0, BASE_CELLS[role]]
    np.testing.assert_allclose(reading.red_level, 100.0)
    np.testing.assert_array_equal(reading.digits[0], digits_of_code(CODE))


def imaging(**changes: object) -> ImagingOptions:
    return replace(ImagingOptions(), **changes)  # type: ignore[arg-type]


LIGHTS = {
    "dim": imaging(exposure_ev=-3.0),
    "over-exposed": imaging(exposure_ev=1.0),
    "warm": imaging(white_balance_rgb=(1.3, 1.0, 0.55)),
    "cold": imaging(white_balance_rgb=(0.7, 1.0, 1.5)),
    "processed": imaging(contrast=0.6, sharpening=0.6, jpeg_quality=70),
}


@pytest.fixture(scope="module")
def lit_shots(plates_scene: Scene) -> dict[str, Shot]:
    return dict(zip(LIGHTS, photographs(plates_scene, LIGHTS.values()), strict=True))


@pytest.mark.parametrize("light", LIGHTS)
def test_no_light_and_no_phone_flips_a_digit(lit_shots: dict[str, Shot], light: str) -> None:
    shot = lit_shots[light]
    reading = read(shot)
    np.testing.assert_array_equal(reading.digits, np.stack([digits_of_code(target.code) for target in shot.truth]))
    assert reading.red_base.all()


def test_a_lamp_beside_the_plates_flips_no_digit(plates_scene: Scene) -> None:
    """Light that falls to a third within a plate's reach of the lamp."""
    place_m = plates_scene.targets[8].site_from_target.position_m + np.array([0.1, 0.0, -0.25])
    lit = replace(plates_scene, lamps=(Lamp(place_m, (0.5, 0.45, 0.3)),), ambient_rgb=(0.15, 0.15, 0.2))
    shot = photograph(lit, ImagingOptions(exposure_ev=-0.5))
    reading = read(shot)
    dots = reading.red_level[8]
    assert dots.max() > 1.3 * dots.min()  # there is a gradient to follow
    np.testing.assert_array_equal(reading.digits, np.stack([digits_of_code(target.code) for target in shot.truth]))


def test_channels_stand_where_opencv_puts_them(plates_shot: Shot) -> None:
    homographies = true_homographies(plates_shot)
    patches = take_patches(Pyramid.of(plates_shot.bgr, 1), homographies, PatchGrid.FINE)
    amplitudes = fit_patches(patches, np.full(len(homographies), 0.75)).amplitudes
    assert (amplitudes[:, BASE, RED] > 10 * np.abs(amplitudes[:, BASE, GREEN])).all()
    assert set(BASE) | set(DIGITS) == set(range(16)) and list(DIGIT_CELLS) == DIGITS
