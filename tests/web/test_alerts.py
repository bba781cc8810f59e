"""Alerts in the browser: a target that was moved is named, found on the plan and in the room, and known of."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from tests.api.bumped_room import MOVED, UNKNOWN, VIEWS_M, Watched, bumped_room
from tests.api.serving import Served
from tests.web.prebuilt import Room
from tests.web.screenshots import keep_screenshot


@pytest.fixture(scope="module")
def bumped(web_served: Served, web_room: Room) -> Watched:
    return bumped_room(web_served, web_room.site_id)


def test_a_moved_target_is_told_shown_and_known(page: Page, bumped: Watched, web_served: Served) -> None:
    told = web_served.client.get(f"/sites/{bumped.site_id}/alerts", params={"kind": "moved-target"}).json()
    (alert,) = told["alerts"]
    page.goto(f"/#/sites/{bumped.site_id}/alerts")
    expect(page.get_by_text(f"{len(VIEWS_M)} snapshots were held against version 1")).to_be_visible()
    listed = page.get_by_role("list", name="Open alerts").get_by_role("button")
    expect(listed).to_have_count(2)
    moved = alert["displacement"]
    expect(listed.first).to_contain_text(
        f"Target {MOVED} stands {moved['distance_mm']:.1f} ± {moved['sigma_mm']:.1f} mm off"
    )
    detail = page.get_by_role("region", name="Alert", exact=True)
    expect(detail).to_contain_text(f"x +{moved['vector_mm'][0]:.1f}")
    sightings = detail.get_by_role("region", name="Snapshots that tell of it").get_by_role("row")
    expect(sightings).to_have_count(len(VIEWS_M) + 1)
    expect(sightings.nth(1)).to_contain_text("left out")
    keep_screenshot(page, "alerts")

    listed.last.click()
    expect(detail).to_contain_text(f"Target {UNKNOWN} is not in the map")
    expect(page).to_have_url(re.compile("alert="))
    page.get_by_label(re.compile("Plan of 1 alerts")).press("ArrowRight")  # the one that has a place there
    expect(detail).to_contain_text(f"Target {MOVED} stands")
    detail.get_by_label("Note").fill("the door hit it")
    detail.get_by_role("button", name="This is known").click()
    expect(detail).to_contain_text("the door hit it")
    expect(listed.first).to_contain_text("known")
    assert web_served.client.get(f"/alerts/{alert['alert_id']}").json()["note"] == "the door hit it"
    detail.get_by_role("link", name="See it in the room").click()
    expect(page.get_by_role("heading", name=f"Target {MOVED}")).to_be_visible()


def test_no_alert_says_how_many_looked(page: Page, web_room: Room, web_served: Served) -> None:
    page.goto(f"/#/sites/{web_room.site_id}/alerts")
    watched = web_served.client.get(f"/sites/{web_room.site_id}/alerts").json()["watched"]["snapshots"]
    text = f"{watched} snapshot" if watched else "No snapshot was located with version 1"
    expect(page.get_by_text(text)).to_be_visible()
    page.goto(f"/#/sites/{web_served.new_site(name='Nothing to watch')}/alerts")
    expect(page.get_by_text("there is nothing to watch")).to_be_visible()
