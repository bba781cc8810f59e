"""What each code family makes of a misread and of a hidden dot, in a photograph."""

from __future__ import annotations

import pytest

from app.geometry.observations import Detection
from app.planning.imaging import ImagingOptions
from app.planning.scene import Panel, PostedTarget
from app.targets.digits import code_of_digits, digits_of_code
from app.targets.family import FAMILY_NAMES, CodeFamily, family_by_name
from app.targets.layout import DIGIT_CELLS
from app.vision.detector import detect
from tests.vision.scenes import U_M, before_wall, facing_panel, found, photograph, plate_at, refused

PX_PER_U = 8.0
DIGIT = 4  # one of the eleven; any would do
CHAIR_RGB = (120, 120, 120)  # grey is no ink of a target; what looks like one would be misread instead


def plate_of(code: int) -> PostedTarget:
    return plate_at((320.0, 240.0), PX_PER_U, code, (0.2, -0.1, 0.4))


def some_code(family: CodeFamily) -> int:
    """A code whose digit is no black one, so that hiding or misreading it changes something."""
    return next(code for code in family.codes[len(family.codes) // 2 :].tolist() if digits_of_code(code)[DIGIT])


def misread(code: int) -> int:
    """The same word with one digit black."""
    digits = digits_of_code(code).copy()
    digits[DIGIT] = 0
    return code_of_digits(digits)


def cover(target: PostedTarget) -> Panel:
    """Something that hides one dot and nothing else, held just before the plate."""
    dot_m = target.dots_m()[DIGIT_CELLS[DIGIT]]
    return facing_panel(0.99 * dot_m, (2.4 * U_M, 2.4 * U_M), CHAIR_RGB)


def seen(family: CodeFamily, target: PostedTarget, *panels: Panel) -> Detection:
    return detect(photograph(before_wall([target], *panels), ImagingOptions()).bgr, family)


@pytest.mark.parametrize("name", FAMILY_NAMES)
def test_every_family_is_read(name: str) -> None:
    family = family_by_name(name)
    code = some_code(family)
    assert found(seen(family, plate_of(code))).keys() == {code}


@pytest.mark.parametrize("name", ["golay", "hamming"])
def test_one_misread_dot_is_mended_where_the_distance_allows(name: str) -> None:
    family = family_by_name(name)
    code = some_code(family)
    detection = seen(family, plate_of(misread(code)))
    assert found(detection).keys() == {code}
    assert (found(detection)[code].corrected, found(detection)[code].erased) == (1, 0)


def test_parity_detects_a_misread_dot_and_full_cannot() -> None:
    parity, full = family_by_name("parity"), family_by_name("full")
    code = some_code(parity)
    detection = seen(parity, plate_of(misread(code)))
    assert detection.targets == ()
    assert refused(detection) == ["code-not-in-family"]
    assert found(seen(full, plate_of(misread(code)))).keys() == {misread(code)}


@pytest.mark.parametrize("name", ["golay", "hamming", "parity"])
def test_one_hidden_dot_is_filled_where_the_distance_allows(name: str) -> None:
    family = family_by_name(name)
    code = some_code(family)
    detection = seen(family, plate_of(code), cover(plate_of(code)))
    assert found(detection).keys() == {code}
    target = found(detection)[code]
    assert (target.corrected, target.erased) == (0, 1)


def test_full_reads_nothing_behind_a_hidden_dot() -> None:
    full = family_by_name("full")
    code = some_code(full)
    assert seen(full, plate_of(code), cover(plate_of(code))).targets == ()
