"""Trajectories in the browser: found, seen from above and over time, inspected, saved, followed while they grow."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Locator, Page, expect

from app.trajectories.formats import csv_text
from tests.api.serving import Served, room_photos
from tests.api.test_trajectories import black
from tests.api.test_trajectory_import import imported
from tests.trajectories.walks import walk
from tests.web.prebuilt import Room, surveyed_room
from tests.web.screenshots import keep_screenshot
from tests.web.waiting import wait_until

# How many dots a plan draws; whether a canvas has so many pixels that something is drawn on.
COUNT_DOTS = """() => { window.dots = 0; const arc = Path2D.prototype.arc;
  Path2D.prototype.arc = function (...given) { window.dots += 1; return arc.apply(this, given); }; }"""
INKED = """([selector, least]) => {
  const canvas = document.querySelector(selector);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let inked = 0;
  for (let at = 3; at < data.length; at += 4) inked += data[at] > 0;
  return inked >= least; }"""


@pytest.fixture(scope="module")
def own_room(web_served: Served, tmp_path_factory: pytest.TempPathFactory) -> Room:
    """A room whose trajectories may grow."""
    return surveyed_room(web_served, tmp_path_factory, as_new=True)


def fact(page: Page, name: str) -> Locator:
    return page.get_by_label("Pose", exact=True).locator(f"dt:text-is('{name}') + dd")


def test_a_trajectory_is_found_by_what_it_holds(page: Page, web_room: Room) -> None:
    page.goto(f"/#/sites/{web_room.site_id}/trajectories")
    row = page.get_by_role("row").filter(has=page.locator(f'a[href="#/trajectories/{web_room.trajectory_id}"]'))
    expect(row).to_contain_text("no-targets")
    page.get_by_label("Through the box").fill("90, 90, 99, 99")
    page.get_by_role("button", name="Filter").click()
    expect(page.get_by_text("No trajectory has a snapshot that fits all of this.")).to_be_visible()
    page.reload()  # the address keeps the filter
    expect(page.get_by_label("Through the box")).to_have_value("90, 90, 99, 99")
    page.get_by_label("Through the box").fill("1, 2, 3")
    page.get_by_role("button", name="Filter").click()
    expect(page.get_by_role("alert")).to_contain_text("got 3 numbers")
    page.get_by_role("button", name="Clear").click()
    page.get_by_label("Device").fill("phone")
    page.get_by_label("Largest").fill("100")
    page.get_by_role("button", name="Filter").click()
    expect(row.get_by_role("link")).to_be_visible()
    keep_screenshot(page, "trajectories")
    row.get_by_role("link").click()
    expect(page.get_by_role("heading", name="phone")).to_be_visible()


def test_a_trajectory_is_seen_inspected_and_saved(
    page: Page, web_room: Room, web_served: Served, tmp_path: Path
) -> None:
    path = f"/trajectories/{web_room.trajectory_id}"
    told = web_served.client.get(path).json()
    page.goto(f"/#{path}")
    expect(page.locator(".figure").filter(has_text="poses").locator("b")).to_have_text(str(told["pose_count"]))
    plan = page.get_by_label(re.compile(r"Plan of \d+ poses"))
    wait_until(page, INKED, [".plan canvas", 1000])
    plan.focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    second = told["poses"][1]
    for name, value, sigma in zip("xyz", second["position_m"], second["position_sigma_m"], strict=True):
        expect(fact(page, name)).to_have_text(f"{value:.3f} m ± {1000 * sigma:.1f} mm")
    wait_until(page, INKED, [".plan-over", 10])  # a ring about it
    page.keyboard.press("+")
    expect(page.get_by_role("button", name="Show all")).to_be_enabled()
    page.get_by_role("button", name="Show all").click()
    chart = page.get_by_label("x over time").locator(".u-over")
    chart.hover(position={"x": 2, "y": 20})
    expect(page.get_by_label("Pose", exact=True)).to_contain_text(f"{told['poses'][0]['position_m'][0]:.3f} m")
    page.get_by_role("combobox", name="Colour", exact=True).select_option("sigma")
    expect(page).to_have_url(re.compile("colour=sigma"))
    expect(page.get_by_label("heading over time").locator("canvas")).to_be_visible()
    keep_screenshot(page, "trajectory")
    expect(page.get_by_label("7 poses, 1 failures, 0 gaps over time")).to_be_visible()
    expect(page.get_by_role("region", name="Failures")).to_contain_text("no-targets")
    with page.expect_download() as download:
        page.get_by_role("button", name="CSV").click()
    download.value.save_as(tmp_path / "walk.csv")
    assert (tmp_path / "walk.csv").read_text() == web_served.client.get(path, params={"format": "csv"}).text
    page.get_by_label("Smoothed").check()
    with page.expect_download() as download:
        page.get_by_role("button", name="TUM").click()
    download.value.save_as(tmp_path / "walk.tum")
    smoothed = web_served.client.get(f"{path}/smoothed", params={"format": "tum", "rate_hz": 10, "max_gap_s": 3}).text
    assert (tmp_path / "walk.tum").read_text() == smoothed
    page.get_by_role("button", name="GeoJSON").click()  # the site has no geo-anchor
    expect(page.get_by_role("alert")).to_contain_text("anchor")


def test_poses_and_failures_appear_as_they_come(page: Page, own_room: Room, web_served: Served) -> None:
    body = {"site_id": own_room.site_id, "device_id": "phone", "name": "Live walk"}
    trajectory_id = web_served.client.post("/trajectories", json=body).json()["trajectory_id"]
    page.goto(f"/#/trajectories/{trajectory_id}")
    expect(page.get_by_text("No pose yet.")).to_be_visible()
    expect(page.get_by_text("live", exact=True)).to_be_visible()
    located = web_served.locate(
        own_room.site_id,
        next(iter(room_photos("locate").values())),
        trajectory_id=trajectory_id,
        captured_at="2026-05-01T10:00:00Z",
    )
    assert located.status_code == 200, located.text
    figures = page.locator(".figure b")
    expect(figures.nth(0)).to_have_text("1")
    web_served.locate(own_room.site_id, black(), trajectory_id=trajectory_id, captured_at="2026-05-01T10:00:01Z")
    expect(page.get_by_text(re.compile("failures: 1 . no-targets"))).to_be_visible()
    page.reload()
    expect(figures.nth(0)).to_have_text("1")
    page.get_by_role("button", name="Close the trajectory").click()
    expect(page.get_by_role("button", name="Close the trajectory")).to_have_count(0)


def test_ten_thousand_poses_stay_light(page: Page, web_served: Served) -> None:
    site_id = web_served.new_site(name="Long walk")
    covariances = np.tile(np.diag([1e-6] * 6), (10_000, 1, 1))
    text = "".join(csv_text([walk(1000.0, 10.0, covariances=covariances)]))
    trajectory_id = imported(web_served, text, site_id=site_id, name="long")["trajectory_id"]
    page.goto(f"/#/trajectories/{trajectory_id}")
    expect(page.locator(".figure b").first).to_have_text("10,000")
    page.evaluate(COUNT_DOTS)
    page.get_by_label(re.compile("Plan of 10,?000 poses")).focus()
    page.keyboard.press("0")
    wait_until(page, "() => window.dots > 100")
    assert page.evaluate("window.dots") < 6000  # dots that would cover each other are drawn once
    page.keyboard.press("End")
    expect(page.get_by_label("Pose", exact=True)).to_contain_text("10,000")
