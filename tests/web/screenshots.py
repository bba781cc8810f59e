"""Pictures of pages for the documents, made anew only when somebody asks for that."""

from __future__ import annotations

import os
from pathlib import Path

from playwright.sync_api import Page

IMAGES = Path(__file__).parents[2] / "docs" / "images"
VARIABLE = "SCATTERMARK_SCREENSHOTS"


def keep_screenshot(page: Page, name: str) -> None:
    """Renew ``docs/images/<name>.png`` when SCATTERMARK_SCREENSHOTS=1 asks for it."""
    if os.environ.get(VARIABLE) == "1":
        page.evaluate("scrollTo(0, 0)")
        page.screenshot(path=IMAGES / f"{name}.png")
