"""The browser of the tests: a Chromium that is there, or that this machine's package manager brings."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome-stable", "google-chrome")
VARIABLE = "SCATTERMARK_CHROMIUM"
# A test's browser talks to nobody but the page: no updates, no synchronisation, no telemetry.
ARGUMENTS = (
    "--no-sandbox",
    "--disable-gpu-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    # There is no graphics card to be spared: pages are drawn and put together by Skia at a quarter of the time that
    # its imitation takes. The room's WebGL goes on through the imitation.
    "--disable-gpu-compositing",
    "--disable-gpu-rasterization",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)


class NoBrowser(Exception):
    """There is no Chromium, and none could be installed."""


def find_chromium() -> str | None:
    """The path of a Chromium that is installed."""
    named = os.environ.get(VARIABLE)
    if named:
        return named
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    return found or _of_playwright()


def _of_playwright() -> str | None:
    """The one that ``playwright install chromium`` brought."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        path = playwright.chromium.executable_path
    return path if Path(path).exists() else None


def install_chromium() -> str:
    """Bring a Chromium: from Debian's packages where that may be done, otherwise from Playwright.

    Raises
    ------
    NoBrowser
    """
    commands = []
    if shutil.which("apt-get"):
        rights = [] if os.geteuid() == 0 else ["sudo", "-n"]
        commands += [
            [*rights, "apt-get", "update", "-qq"],
            [*rights, "apt-get", "install", "-qq", "-y", "--no-install-recommends", "chromium"],
        ]
    commands.append([sys.executable, "-m", "playwright", "install", "chromium"])
    for command in commands:
        if shutil.which(command[0]):
            subprocess.run(command, check=False, stdout=sys.stderr.fileno())
        if found := find_chromium():
            return found
    raise NoBrowser(
        "the tests of the pages need Chromium, and neither apt-get nor playwright could install it; install it by hand "
        f"(Debian and Ubuntu: apt install chromium), or name one in {VARIABLE}"
    )


if __name__ == "__main__":
    try:
        sys.stdout.write(f"{find_chromium() or install_chromium()}\n")
    except NoBrowser as error:
        sys.exit(str(error))
