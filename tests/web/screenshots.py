"""Pictures of pages for the documents, made anew only when somebody asks for that."""

from __future__ import annotations

import io
import os
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Page

IMAGES = Path(__file__).parents[2] / "docs" / "images"
VARIABLE = "SCATTERMARK_SCREENSHOTS"
COLOURS = 256  # of a palette: with one a picture takes a third of the room
PLAIN = 32  # of them: those that most pixels have are kept as they are, so that grounds stay what they were


def keep_screenshot(page: Page, name: str) -> None:
    """Renew ``docs/images/<name>.png`` when SCATTERMARK_SCREENSHOTS=1 asks for it."""
    if os.environ.get(VARIABLE) == "1":
        page.evaluate("scrollTo(0, 0)")
        taken = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
        with_palette(taken).save(IMAGES / f"{name}.png", optimize=True)


def with_palette(picture: Image.Image) -> Image.Image:
    """The picture in few colours: the most frequent ones, and others spread over all that occur."""
    counted = picture.getcolors(picture.width * picture.height) or []
    frequent = [colour for _, colour in sorted(counted, reverse=True)[:PLAIN]]
    spread = picture.quantize(COLOURS - PLAIN, method=Image.Quantize.FASTOCTREE).getpalette() or []
    palette = Image.new("P", (1, 1))
    palette.putpalette([*(value for colour in frequent for value in colour), *spread])
    pixels = np.asarray(picture)
    places = np.array(picture.quantize(palette=palette, dither=Image.Dither.NONE))
    for place, colour in enumerate(frequent):  # the search is a rough one: it takes a near white for white
        places[np.all(pixels == colour, axis=-1)] = place
    reduced = Image.fromarray(places, "P")
    reduced.putpalette(palette.getpalette() or [])
    return reduced
