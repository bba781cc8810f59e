"""Waiting for what a page does, where no locator tells it."""

from __future__ import annotations

import time

from playwright.sync_api import Page

PATIENCE_MS = 60_000  # machines that run tests are loaded


def wait_until(page: Page, ask: str, argument: object = None) -> None:
    """Ask frame after frame; Playwright's own wait evaluates text, which the pages' policy forbids."""
    deadline_s = time.monotonic() + PATIENCE_MS / 1000
    while not page.evaluate(ask, argument):
        assert time.monotonic() < deadline_s, ask
        page.evaluate("() => new Promise(requestAnimationFrame)")
