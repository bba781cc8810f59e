"""Every page with real content, measured: axe-core's rules, contrast in light and dark, borders of inputs, 360 px."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from app.trajectories.robotics_formats import tum_text
from tests.api.bumped_room import bumped_room
from tests.api.serving import Served
from tests.api.test_trajectory_import import imported
from tests.trajectories.walks import noisy, walk
from tests.web.conftest import DESK, watched_context
from tests.web.prebuilt import Room
from tests.web.waiting import wait_until

SCRIPTS = Path(__file__).parent / "scripts"
AXE = (Path(__file__).parent / "vendor" / "axe.min.js").read_text()
PHONE = {"width": 360, "height": 740}
LEAST_OF_PARTS = 3.0  # WCAG 2.2, 1.4.11: what a control is known by, and its focus

FAULTS = (SCRIPTS / "faults.js").read_text()

PARTS = (SCRIPTS / "parts.js").read_text()


@dataclass(frozen=True)
class Sites:
    """Addresses of pages with content: the names of what they show."""

    ids: dict[str, str]


@pytest.fixture(scope="module")
def sites(web_served: Served, web_room: Room) -> Sites:
    client, site_id = web_served.client, web_served.new_site(name="Evaluated")
    files = ["".join(tum_text([one])) for one in (walk(30.0), noisy(walk(30.0), 0.05, seed=1))]
    both = [
        imported(web_served, text, site_id=site_id, name=name)["trajectory_id"]
        for text, name in zip(files, ("truth", "uwb"), strict=True)
    ]
    evaluated = client.post("/evaluations", json={"reference_id": both[0], "estimate_id": both[1]})
    open_one = client.post("/trajectories", json={"site_id": web_room.site_id, "device_id": "walker"}).json()
    live = client.post("/evaluations/live", json={"reference_id": open_one["trajectory_id"]})
    return Sites(
        {
            "room": web_room.site_id,
            "survey": web_room.survey_id,
            "walk": web_room.trajectory_id,
            "evaluated": site_id,
            "evaluation": evaluated.json()["evaluation_id"],
            "live": live.json()["live_id"],
            "bumped": bumped_room(web_served, web_room.site_id).site_id,
        }
    )


# Each address, and what is seen once the page is whole.
PAGES = {
    "/": "Demonstration room",
    "/nowhere": "There is no such page",
    "/sites/{room}": "Print targets",
    "/sites/{room}/surveys": "the demonstration room",
    "/sites/{room}/surveys/{survey}": "would be published now",
    "/sites/{room}/surveys/{survey}/photos/IMG_0000.jpg": "targets found",
    "/sites/{room}/report": "Targets",
    "/sites/{room}/room": "Drawn",
    "/sites/{room}/phone": "Phone",
    "/sites/{room}/phone/calibration": "Cameras of this site",
    "/sites/{room}/trajectories": "phone",
    "/trajectories/{walk}": "poses",
    "/sites/{evaluated}/evaluations": "uwb",
    "/evaluations/{evaluation}": "Metrics",
    "/evaluations/live/{live}": "Live",
    "/sites/{bumped}/alerts": "What it rests on",
    "/operator": "Jobs",
}


@pytest.fixture(scope="module")
def reader(chromium: Browser, web_served: Served) -> Any:
    """A page with axe-core in it, shared by all visits."""
    context, watched = watched_context(chromium, web_served, reduced_motion="reduce")
    context.add_init_script(AXE)
    yield context.new_page()
    context.close()
    assert not watched.faults


def faults_of_parts(page: Page) -> list[dict[str, Any]]:
    return [part for part in page.evaluate(PARTS) if min(part["known"], part["focus"]) < LEAST_OF_PARTS]


@pytest.mark.parametrize("address", PAGES)
def test_a_page_is_read_by_everybody(reader: Page, sites: Sites, address: str) -> None:
    page = reader
    page.set_viewport_size(DESK)
    page.emulate_media(color_scheme="light")
    page.goto(f"/#{address.format(**sites.ids)}")
    expect(page.get_by_text(PAGES[address]).filter(visible=True).first).to_be_visible()
    expect(page.get_by_role("status", name="working")).to_have_count(0)
    assert page.evaluate(FAULTS, None) == []
    assert faults_of_parts(page) == []
    page.emulate_media(color_scheme="dark")
    assert page.evaluate(FAULTS, ["color-contrast"]) == []
    assert faults_of_parts(page) == []
    page.set_viewport_size(PHONE)
    wait_until(page, "() => document.documentElement.scrollWidth <= innerWidth")  # charts follow a frame later
