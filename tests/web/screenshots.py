"""Pictures of pages for the documents, made anew only when somebody asks for that."""

from __future__ import annotations

import io
import os
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page

IMAGES = Path(__file__).parents[2] / "docs" / "images"
VARIABLE = "SCATTERMARK_SCREENSHOTS"
COLOURS = 128


def keep_screenshot(page: Page, name: str) -> None:
    """Renew ``docs/images/<name>.png`` when SCATTERMARK_SCREENSHOTS=1 asks for it."""
    if os.environ.get(VARIABLE) == "1":
        page.evaluate("scrollTo(0, 0)")
        taken = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
        # A palette, without dither, is a third of the size and looks the same.
        taken.quantize(COLOURS, dither=Image.Dither.NONE).save(IMAGES / f"{name}.png", optimize=True)
