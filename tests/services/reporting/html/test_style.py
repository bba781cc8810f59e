"""Colours can be read in light and in dark, on paper and by those who see fewer of them."""

from __future__ import annotations

import re

import pytest

from app.services.reporting.html.page import STYLE

TEXT_CONTRAST = 4.5  # WCAG 2.2, 1.4.3, level AA
INKS_OF_TEXT = ("ink", "muted", "target", "photo", "control", "check", "error")


def colours(block: str) -> dict[str, str]:
    return dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block))


def contrast(first: str, second: str) -> float:
    """WCAG 2.2, relative luminance and contrast ratio."""

    def luminance(code: str) -> float:
        channels = [int(code[start : start + 2], 16) / 255 for start in (1, 3, 5)]
        linear = [value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4 for value in channels]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(first), luminance(second)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_stands_out_from_what_is_behind_it(scheme: str) -> None:
    light, rest = STYLE.split("@media screen and (prefers-color-scheme: dark)")
    palette = colours(light if scheme == "light" else rest.split("* {")[0])
    pairs = [(ink, "paper") for ink in INKS_OF_TEXT]
    pairs += [("ink", "sheet"), ("muted", "sheet"), ("ink", "mark"), ("ink", "grave-sheet"), ("grave", "grave-sheet")]
    assert [pair for pair in pairs if contrast(palette[pair[0]], palette[pair[1]]) < TEXT_CONTRAST] == []


def test_print_is_light_and_broad_tables_turn_the_page() -> None:
    assert "@media screen and (prefers-color-scheme: dark)" in STYLE
    assert "@page wide { size: A4 landscape" in STYLE
