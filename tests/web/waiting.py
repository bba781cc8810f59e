"""Waiting for what a page does, where no locator tells it."""

from __future__ import annotations

import time

from playwright.sync_api import Page

PATIENCE_MS = 180_000  # machines that run tests are loaded

# A photograph's view has the shape of its frame: its size has been noticed.
FRAMED = """() => {
  const surface = document.querySelector("svg.photo"), { width, height } = surface.getBoundingClientRect();
  const [, , seen_width, seen_height] = surface.getAttribute("viewBox").split(" ").map(Number);
  return Math.abs(seen_width / seen_height - width / height) < 0.001;
}"""
TWO_FRAMES = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


def wait_until(page: Page, ask: str, argument: object = None) -> None:
    """Ask frame after frame; Playwright's own wait evaluates text, which the pages' policy forbids."""
    deadline_s = time.monotonic() + PATIENCE_MS / 1000
    while not page.evaluate(ask, argument):
        assert time.monotonic() < deadline_s, ask
        page.evaluate("() => new Promise(requestAnimationFrame)")


def await_drawn(page: Page) -> None:
    """All that was done to the page so far is seen: it was asked to draw it before the first of two frames."""
    page.evaluate(TWO_FRAMES)
