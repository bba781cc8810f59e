"""A photograph opened: what was found is drawn where it is, zoom and pan, marks by hand that a build takes."""

from __future__ import annotations

from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.api.serving import Served
from tests.web.conftest import watched_context
from tests.web.prebuilt import Room
from tests.web.screenshots import keep_screenshot
from tests.web.waiting import FRAMED, wait_until

NAME = "IMG_0000.jpg"
MARK_TOLERANCE_PX = 1.0  # of the photograph, at a zoom where a screen pixel is less than half of that


@pytest.fixture
def detection(web_room: Room, web_served: Served) -> dict[str, Any]:
    answer = web_served.client.get(f"/surveys/{web_room.survey_id}/images/{NAME}/detection")
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def open_photo(page: Page, room: Room) -> None:
    page.goto(f"/#/sites/{room.site_id}/surveys/{room.survey_id}/photos/{NAME}")
    expect(page.get_by_role("button", name="Mark in the photograph")).to_be_visible()  # from here on nothing moves
    wait_until(page, FRAMED)


def scale_of(page: Page) -> int:
    return int(page.locator(".photo-scale").inner_text().removesuffix(" %"))


def test_what_was_found_is_drawn_where_it_is(page: Page, web_room: Room, detection: dict[str, Any]) -> None:
    open_photo(page, web_room)
    expect(page.get_by_role("heading", name=f"{len(detection['targets'])} targets found")).to_be_visible()
    expect(page.locator(".overlay .found")).to_have_count(len(detection["targets"]))
    expect(page.locator(".overlay .refused")).to_have_count(len(detection["rejected"]))
    keep_screenshot(page, "photo")
    target = detection["targets"][0]
    whole = scale_of(page)
    page.get_by_role("region", name="Found").get_by_role("button", name=str(target["code"])).click()
    circles = page.locator(".overlay .picked circle")
    expect(circles).to_have_count(16)
    assert scale_of(page) > 3 * whole
    drawn = circles.evaluate_all("dots => dots.map((dot) => [dot.cx.baseVal.value, dot.cy.baseVal.value])")
    for place_px, expected_px in zip(drawn, target["dots_px"], strict=True):
        assert place_px == pytest.approx(expected_px, abs=1e-3)
    page.get_by_role("checkbox", name="found").uncheck()
    expect(page.locator(".overlay .found")).to_have_count(0)


def test_a_photograph_is_moved_and_zoomed_by_wheel_keys_and_buttons(page: Page, web_room: Room) -> None:
    open_photo(page, web_room)
    surface = page.get_by_role("application")
    whole, box = surface.get_attribute("viewBox"), surface.bounding_box()
    assert whole and box
    page.mouse.move(box["x"] + 200, box["y"] + 150)
    page.mouse.wheel(0, -600)
    expect(surface).not_to_have_attribute("viewBox", whole)
    zoomed = surface.get_attribute("viewBox")
    assert zoomed
    # What lies under the pointer stays there.
    before, after = ([float(part) for part in text.split()] for text in (whole, zoomed))
    for axis, place in ((0, 200 / box["width"]), (1, 150 / box["height"])):
        under = [view[axis] + place * view[2 + axis] for view in (before, after)]
        assert under[0] == pytest.approx(under[1], abs=1.0)
    page.mouse.down()
    page.mouse.move(box["x"] + 260, box["y"] + 150, steps=3)
    page.mouse.up()
    expect(surface).not_to_have_attribute("viewBox", zoomed)
    surface.press("0")
    expect(surface).to_have_attribute("viewBox", whole)
    surface.press("+")
    expect(surface).not_to_have_attribute("viewBox", whole)
    page.get_by_role("button", name="All", exact=True).click()
    expect(surface).to_have_attribute("viewBox", whole)


def test_dots_are_marked_with_the_loupe_and_kept(
    page: Page, web_room: Room, web_served: Served, detection: dict[str, Any]
) -> None:
    target = detection["targets"][0]
    open_photo(page, web_room)
    page.get_by_role("region", name="Found").get_by_role("button", name=str(target["code"])).click()
    marks = page.get_by_role("region", name="Marks")
    marks.get_by_label("Code").fill("16926")
    expect(marks.get_by_text("is no code of the family golay")).to_be_visible()
    marks.get_by_label("Code").fill(str(target["code"]))
    marks.get_by_role("button", name="Mark in the photograph").click()
    expect(page.locator("svg.loupe")).to_be_visible()
    dot = page.locator(".overlay .picked circle").first.bounding_box()
    assert dot
    page.mouse.click(dot["x"] + dot["width"] / 2, dot["y"] + dot["height"] / 2)
    placed = marks.get_by_role("list", name="Marks that are set").get_by_role("listitem")
    expect(placed).to_have_count(1)
    expect(placed.first).to_contain_text(f"{target['code']} A")
    storing = marks.get_by_text("Storing…")
    expect(storing).to_have_count(0)
    path = f"/surveys/{web_room.survey_id}/images/{NAME}/marks"
    (stored,) = web_served.client.get(path).json()["marks"]
    assert (stored["code"], stored["dot"]) == (target["code"], "A")
    assert [stored["x_px"], stored["y_px"]] == pytest.approx(target["dots_px"][0], abs=MARK_TOLERANCE_PX)
    expect(marks.get_by_label("Dot")).to_have_value("B")
    surface = page.get_by_role("application")
    surface.press("ArrowRight")
    surface.press("Enter")
    expect(placed).to_have_count(2)
    expect(storing).to_have_count(0)
    page.reload()
    expect(placed).to_have_count(2)
    for _ in range(2):
        marks.get_by_role("button", name=f"Remove {target['code']}").first.click()
    expect(placed).to_have_count(0)
    expect(storing).to_have_count(0)
    assert web_served.client.get(path).json() == {"marks": []}


def test_marks_set_faster_than_they_are_stored_are_all_kept(
    page: Page, web_room: Room, web_served: Served, detection: dict[str, Any]
) -> None:
    address = f"/surveys/{web_room.survey_id}/images/{NAME}/marks"
    held: list[Any] = []
    page.route(f"**{address}", lambda route: held.append(route) if route.request.method == "PUT" else route.continue_())
    open_photo(page, web_room)
    marks = page.get_by_role("region", name="Marks")
    marks.get_by_label("Code").fill(str(detection["targets"][0]["code"]))
    marks.get_by_role("button", name="Mark in the photograph").click()
    surface = page.get_by_role("application", name="Enter sets the mark")
    placed = marks.get_by_role("list", name="Marks that are set").get_by_role("listitem")
    for _ in range(3):
        surface.press("ArrowRight")
        surface.press("Enter")
    expect(placed).to_have_count(3)
    expect(marks.get_by_text("Storing…")).to_be_visible()
    while marks.get_by_text("Storing…").count():
        while held:
            held.pop().continue_()
        page.wait_for_timeout(20)
    page.unroute(f"**{address}")
    assert [mark["dot"] for mark in web_served.client.get(address).json()["marks"]] == ["A", "B", "C"]
    # What the service refuses is told and taken back.
    page.route(f"**{address}", lambda route: route.abort() if route.request.method == "PUT" else route.continue_())
    marks.get_by_role("button", name="Remove").first.click()
    expect(marks.get_by_role("alert")).to_contain_text("cannot be reached")
    expect(placed).to_have_count(3)
    page.unroute(f"**{address}")
    web_served.client.put(address, json={"marks": []})


def test_on_a_phone_the_photograph_comes_first(chromium: Browser, web_room: Room, web_served: Served) -> None:
    context, watched = watched_context(chromium, web_served, has_touch=True)
    page = context.new_page()
    page.set_viewport_size({"width": 360, "height": 740})
    open_photo(page, web_room)
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    photo, side = page.get_by_role("application").bounding_box(), page.locator(".photo-side").bounding_box()
    assert photo and side and photo["y"] < side["y"]
    context.close()
    assert not watched.faults
