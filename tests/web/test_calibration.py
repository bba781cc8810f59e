"""A phone's camera is calibrated in the browser: what photographs show, what was found, refusals, the camera's end."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Page, Route, expect

from tests.api.serving import ROOM, Served
from tests.web.prebuilt import Room, surveyed_room
from tests.web.screenshots import keep_screenshot

PHOTOGRAPHS = sorted((ROOM / "survey").glob("*.jpg"))[:9]
WITHOUT_TARGETS = ROOM / "locate" / "IMG_0005.jpg"


@pytest.fixture(scope="module")
def own_room(web_served: Served, tmp_path_factory: pytest.TempPathFactory) -> Room:
    """A room that may have more cameras."""
    return surveyed_room(web_served, tmp_path_factory, as_new=True)


def test_a_camera_is_calibrated_seen_used_and_forgotten(page: Page, own_room: Room, web_served: Served) -> None:
    page.goto(f"/#/sites/{own_room.site_id}/phone/calibration")
    shows = page.get_by_role("region", name="What the set shows")
    expect(shows.get_by_text("0 show targets; 5 more")).to_be_visible()
    opening: list[Route] = []
    page.route("**/surveys", lambda route: opening.append(route))
    page.get_by_label("Choose photographs").first.set_input_files(PHOTOGRAPHS[:1])
    page.get_by_label("Choose photographs").first.set_input_files(PHOTOGRAPHS[1:4])  # while the set is being opened
    (held,) = opening
    held.continue_()
    expect(shows.get_by_text("4 show targets; 1 more")).to_be_visible()
    expect(page.get_by_role("button", name="Calibrate with 4 photographs")).to_be_disabled()
    page.get_by_label("Choose photographs").first.set_input_files(PHOTOGRAPHS[4:])
    expect(shows.get_by_role("img", name="Where targets fell: 83 % of the picture hold dots")).to_be_visible()
    # Each plate that the service found stands in the frame; a photograph that is pointed at shows its own.
    survey_id = page.url.partition("survey=")[2].partition("&")[0]
    found = [
        len(web_served.client.get(f"/surveys/{survey_id}/images/{path.name}/detection").json()["targets"])
        for path in PHOTOGRAPHS
    ]
    expect(shows.locator("polygon")).to_have_count(sum(found))
    page.get_by_role("list", name="Photographs of the set").get_by_role("link").first.focus()
    expect(shows.locator(".picked polygon")).to_have_count(found[0])

    page.get_by_label("Phone's name").fill("phone-9")
    page.get_by_role("button", name="Calibrate with 9 photographs").click()
    expect(page.get_by_text("snapshots of phone-9 are located with it")).to_be_visible()
    (camera,) = web_served.client.get("/cameras", params={"device_id": "phone-9"}).json()["cameras"]
    intrinsics = page.get_by_role("region", name="Intrinsics").get_by_role("row")
    expect(intrinsics.filter(has_text="focal length across")).to_contain_text(f"{camera['fx']:.2f}")
    expect(intrinsics.filter(has_text="focal length across")).to_contain_text(f"{camera['sigmas']['fx']:.2f}")
    expect(page.get_by_role("region", name="Photographs by their residuals").get_by_role("row")).to_have_count(10)
    keep_screenshot(page, "calibration")
    page.reload()  # the address keeps the set and its calibration
    expect(page.get_by_text("snapshots of phone-9 are located with it")).to_be_visible()
    expect(page.get_by_role("link", name="Locate with it")).to_be_visible()

    row = page.get_by_role("region", name="Cameras").get_by_role("row").filter(has_text="phone-9")
    expect(row).to_contain_text("calibration")
    row.get_by_role("button", name="Forget").click()
    page.get_by_role("dialog").get_by_role("button", name="Forget it").click()
    expect(row).to_have_count(0)
    assert web_served.client.get("/cameras", params={"device_id": "phone-9"}).json()["cameras"] == []


def test_photographs_that_carry_no_calibration_are_refused_with_advice(
    page: Page, own_room: Room, tmp_path: Path
) -> None:
    """One photograph five times: nothing tells focal length and distance apart."""
    copies = [tmp_path / f"same{index}.jpg" for index in range(5)]
    for index, copy in enumerate(copies):
        copy.write_bytes(PHOTOGRAPHS[5].read_bytes() + b"\0" * index)  # else the service knows it by its digest
    page.goto(f"/#/sites/{own_room.site_id}/phone/calibration")
    page.get_by_label("Choose photographs").first.set_input_files([*copies, WITHOUT_TARGETS])
    photographs = page.get_by_role("list", name="Photographs of the set").get_by_role("listitem")
    expect(photographs.filter(has_text=WITHOUT_TARGETS.name)).to_contain_text("no target")
    page.get_by_role("button", name="Calibrate with 5 photographs").click()
    expect(page.get_by_text("These photographs do not calibrate a camera.")).to_be_visible()
    expect(page.get_by_role("alert").filter(has_text="turn the phone by a quarter turn")).to_be_visible()


def test_a_site_without_a_map_says_what_to_do_first(page: Page, web_served: Served) -> None:
    page.goto(f"/#/sites/{web_served.new_site(name='Bare of cameras')}/phone/calibration")
    expect(page.get_by_text("This site has no target map yet")).to_be_visible()
    expect(page.get_by_text("No camera yet")).to_be_visible()
