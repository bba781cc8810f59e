"""A real browser on the real service. A page that asks another host, or complains in its console, fails its test."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, Request, expect, sync_playwright

from app.settings import Settings
from tests.api.serving import Served, serve
from tests.web.chromium import ARGUMENTS, NoBrowser, find_chromium
from tests.web.prebuilt import Room, surveyed_room
from tests.web.waiting import PATIENCE_MS

DESK = {"width": 1280, "height": 860}
expect.set_options(timeout=PATIENCE_MS)


@pytest.fixture(scope="session")
def web_served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A service without keys, with a worker for builds."""
    settings = Settings(data_dir=tmp_path_factory.mktemp("web"), locate_workers=1, build_workers=2)
    with serve(settings) as running:
        yield running


@pytest.fixture(scope="session")
def web_room(web_served: Served, tmp_path_factory: pytest.TempPathFactory) -> Room:
    """The demonstration room, surveyed, with its snapshots located in one trajectory."""
    return surveyed_room(web_served, tmp_path_factory)


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    """A browser for the tests of one file: while it runs, its driver's event loop is this thread's only one."""
    path = find_chromium()
    if path is None:
        raise NoBrowser("there is no Chromium; `make test` installs one, or run python -m tests.web.chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(ARGUMENTS))
        yield browser
        browser.close()


@dataclass
class Watched:
    """What a page did that no page may do."""

    own_address: str
    faults: list[str]

    def on_console(self, message: ConsoleMessage) -> None:
        # The browser reports each answer that is no success as an error; pages show those themselves.
        if message.type == "error" and "Failed to load resource" not in message.text:
            self.faults.append(f"console: {message.text}")

    def on_request(self, request: Request) -> None:
        if not request.url.startswith((self.own_address, "blob:", "data:")):
            self.faults.append(f"another host: {request.url}")

    def on_error(self, error: Exception) -> None:
        self.faults.append(f"uncaught: {getattr(error, 'stack', error)}")

    def watch(self, page: Page) -> None:
        page.on("console", self.on_console)
        page.on("request", self.on_request)
        page.on("pageerror", self.on_error)


def watched_context(browser: Browser, served: Served, **options: object) -> tuple[BrowserContext, Watched]:
    """A context whose pages are watched."""
    address = str(served.client.base_url).rstrip("/")
    context = browser.new_context(base_url=address, viewport=DESK, **options)  # type: ignore[arg-type]
    context.set_default_timeout(PATIENCE_MS)
    watched = Watched(address, [])
    context.on("page", watched.watch)
    return context, watched


@pytest.fixture
def page(chromium: Browser, web_served: Served) -> Iterator[Page]:
    """An empty page of a browser of its own."""
    context, watched = watched_context(chromium, web_served)
    yield context.new_page()
    context.close()
    assert not watched.faults


@pytest.fixture(scope="session")
def screenshots(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where tests put what they saw."""
    return tmp_path_factory.mktemp("screenshots")
