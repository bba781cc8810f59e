"""Colours can be read in light and in dark, on paper and by those who see fewer of them."""

from __future__ import annotations

import re
from itertools import combinations, pairwise

import numpy as np
import numpy.typing as npt
import pytest

from app.services.reporting.html.page import STYLE

Array = npt.NDArray[np.float64]

TEXT_CONTRAST = 4.5  # WCAG 2.2, 1.4.3, level AA
STROKE_CONTRAST = 3.0  # the same, 1.4.11
DIFFERENCE = 10.0  # of CIE L*a*b*: some ten times what can just be seen side by side
GREY_STEP = 1.3  # of contrast from one size to the next
XYZ_FROM_RGB = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
# Machado, Oliveira and Fernandes, IEEE TVCG 15(6), 2009, severity 1, on linear sRGB.
SIGHTS = {
    "full": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    "without red": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "without green": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "without blue": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
INKS_OF_TEXT = ("ink", "muted", "target", "photo", "control", "check", "error")


def colours(block: str) -> dict[str, str]:
    return dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block))


def contrast(first: str, second: str) -> float:
    """WCAG 2.2, relative luminance and contrast ratio."""

    low, high = sorted(float(XYZ_FROM_RGB[1] @ linear(code)) for code in (first, second))
    return (high + 0.05) / (low + 0.05)


def linear(code: str) -> Array:
    """Linear sRGB, shape (3,)."""
    channels = np.array([int(code[start : start + 2], 16) / 255 for start in (1, 3, 5)])
    return np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)


def lab(rgb: Array) -> Array:
    """CIE L*a*b* of linear sRGB, white D65."""
    share = XYZ_FROM_RGB @ np.clip(rgb, 0.0, 1.0) / XYZ_FROM_RGB.sum(axis=1)
    root = np.where(share > 216 / 24389, np.cbrt(share), (24389 / 27 * share + 16) / 116)
    return np.array([116 * root[1] - 16, 500 * (root[0] - root[1]), 200 * (root[1] - root[2])])


@pytest.fixture(params=["light", "dark"])
def palette(request: pytest.FixtureRequest) -> dict[str, str]:
    light, rest = STYLE.split("@media screen and (prefers-color-scheme: dark)")
    return colours(light if request.param == "light" else rest.split("* {")[0])


@pytest.mark.parametrize("sight", SIGHTS)
def test_series_and_sizes_are_told_apart_by_all(palette: dict[str, str], sight: str) -> None:
    for family in ("series", "size"):
        seen = [
            lab(np.array(SIGHTS[sight]) @ linear(code)) for name, code in palette.items() if name.startswith(family)
        ]
        assert len(seen) == {"series": 6, "size": 5}[family]
        assert min(np.linalg.norm(first - second) for first, second in combinations(seen, 2)) > DIFFERENCE


def test_sizes_keep_their_order_without_colours(palette: dict[str, str]) -> None:
    contrasts = [contrast(palette[f"size{rank}"], palette["paper"]) for rank in range(1, 6)]
    assert contrasts == sorted(contrasts)
    assert min(late / early for early, late in pairwise(contrasts)) > GREY_STEP


def test_strokes_stand_out_from_the_paper(palette: dict[str, str]) -> None:
    strokes = [name for name in palette if name.startswith(("series", "size"))]
    assert [name for name in strokes if contrast(palette[name], palette["paper"]) < STROKE_CONTRAST] == []


def test_text_stands_out_from_what_is_behind_it(palette: dict[str, str]) -> None:
    pairs = [(ink, "paper") for ink in INKS_OF_TEXT]
    pairs += [("ink", "sheet"), ("muted", "sheet"), ("ink", "mark"), ("ink", "grave-sheet"), ("grave", "grave-sheet")]
    assert [pair for pair in pairs if contrast(palette[pair[0]], palette[pair[1]]) < TEXT_CONTRAST] == []


def test_print_is_light_and_broad_tables_turn_the_page() -> None:
    assert "@media screen and (prefers-color-scheme: dark)" in STYLE
    assert "@page wide { size: A4 landscape" in STYLE
