from __future__ import annotations

import re

from app.services.reporting.html.page import STYLE
from app.services.reporting.pdf.fonts import written
from app.services.reporting.pdf.look import INKS


def test_characters_beyond_the_font_are_named() -> None:
    assert written("Łódź Ωmega − ± µ") == "Łódź Ωmega − ± µ"  # noqa: RUF001 - a real minus
    assert written("会 🙂") == "[U+4F1A] [U+1F642]"
    assert written("a\u202eb\x00") == "a�b�"


def test_colours_are_those_of_the_page() -> None:
    light = dict(re.findall(r"--(\w+): (#[0-9a-f]{6})", STYLE.split("@media")[0]))
    assert {name: colour.hexval().replace("0x", "#") for name, colour in INKS.items()} == {
        name: light[name] for name in INKS
    }
