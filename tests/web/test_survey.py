"""A survey by browser: photographs uploaded, control points pasted, built, its report read; nothing is sent twice."""

from __future__ import annotations

import re
from pathlib import Path

from playwright.sync_api import Locator, Page, Request, Route, expect

from app.targets.family import family_by_name
from tests.api.serving import ROOM, Served, room_control_points
from tests.web.prebuilt import Room
from tests.web.screenshots import keep_screenshot

PHOTOS = sorted((ROOM / "survey").glob("*.jpg"))
FIRST_PART = PHOTOS[:5]


def drop_photos(page: Page, files: list[Path]) -> None:
    page.get_by_label("Choose photographs", exact=True).set_input_files(files)


def paste(page: Page, text: str) -> None:
    """From the real clipboard."""
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.evaluate("text => navigator.clipboard.writeText(text)", text)
    page.get_by_label("Paste cells of a spreadsheet").focus()
    page.keyboard.press("ControlOrMeta+V")


def points_part(page: Page) -> Locator:
    return page.get_by_role("region", name="Control points")


def test_a_survey_from_photographs_to_its_report(page: Page, web_served: Served) -> None:
    site_id = web_served.new_site(name="Browser room")
    page.goto(f"/#/sites/{site_id}/surveys")
    page.get_by_role("button", name="New survey").click()
    page.get_by_role("dialog").get_by_label("Note").fill("All walls")
    page.get_by_role("dialog").get_by_role("button", name="Open the survey").click()
    expect(page.get_by_role("heading", name="All walls")).to_be_visible()

    drop_photos(page, FIRST_PART)
    expect(page.get_by_text(f"{len(FIRST_PART)} of {len(FIRST_PART)} photographs")).to_be_visible()
    thumbnails = page.get_by_role("list", name="Photographs of the survey").get_by_role("listitem")
    expect(thumbnails).to_have_count(len(FIRST_PART))
    survey_address = page.url

    # The tab is closed, another one opened, and the whole folder dropped again: only what is missing is sent.
    context = page.context
    page.close()
    page = context.new_page()
    sent: list[str] = []
    page.on("request", lambda request: note_upload(request, sent))
    page.goto(survey_address)
    expect(page.get_by_role("button", name="Build the target map")).to_be_visible()
    drop_photos(page, PHOTOS)
    expect(page.get_by_text(f"{len(PHOTOS)} of {len(PHOTOS)} photographs")).to_be_visible()
    expect(page.get_by_text(f"({len(FIRST_PART)} were there already)")).to_be_visible()
    assert sorted(sent) == [path.name for path in PHOTOS[len(FIRST_PART) :]]
    first = page.get_by_role("list", name="Photographs of the survey").locator("img").first
    expect(first).to_have_js_property("naturalWidth", 320)

    paste(page, room_control_points().replace(",", ";"))
    expect(points_part(page).get_by_text("4 control points and 8 check points.")).to_be_visible()
    page.get_by_label("code of row 1", exact=True).fill("16926")
    expect(points_part(page).get_by_text("is no code of the family golay")).to_be_visible()
    expect(page.get_by_role("button", name="Save the points")).to_be_disabled()
    page.get_by_label("code of row 1", exact=True).fill("16925")
    page.get_by_role("button", name="Save the points").click()
    expect(points_part(page).get_by_role("status").filter(has_text="saved")).to_have_text("saved")

    page.get_by_role("button", name="Build the target map").click()
    progress = page.get_by_role("status", name="Build progress")
    expect(progress.get_by_text("succeeded", exact=True)).to_be_visible(timeout=300_000)
    keep_screenshot(page, "survey")
    page.get_by_role("link", name="See the report").click()
    expect(page.locator(".figure").get_by_text("16 of 16")).to_be_visible()
    worst = page.get_by_role("region", name="Control and check points, the worst first").get_by_role("row").nth(1)
    expect(worst).to_contain_text("check")
    keep_screenshot(page, "report")

    page.get_by_role("checkbox", name="Use IMG_0004.jpg in the next build").uncheck()
    expect(page.get_by_text("Left out: photographs IMG_0004.jpg")).to_be_visible()
    page.get_by_role("button", name="Build the target map").click()
    link = page.get_by_role("link", name="See the report")
    expect(page.get_by_role("status", name="Build progress").get_by_text("Version 2:")).to_be_visible(timeout=300_000)
    link.click()
    expect(page.locator(".figure").get_by_text("15 of 15")).to_be_visible()
    expect(page.get_by_text("Left out on purpose: photographs IMG_0004.jpg.")).to_be_visible()
    expect(page.get_by_role("region", name="Differences, the largest first").get_by_role("row").nth(1)).to_be_visible()


def note_upload(request: Request, sent: list[str]) -> None:
    if request.method == "PUT" and "/images/" in request.url:
        sent.append(request.url.rpartition("/")[2])


def test_uploads_outlast_a_lost_connection_and_refusals_are_told(
    page: Page, web_served: Served, tmp_path: Path
) -> None:
    survey_id = web_served.new_survey(web_served.new_site(name="Lost"), note="lost")
    site_id = web_served.client.get(f"/surveys/{survey_id}").json()["site_id"]
    broken = tmp_path / "broken.jpg"
    broken.write_bytes(b"no picture at all")
    renamed = tmp_path / PHOTOS[0].name
    renamed.write_bytes(PHOTOS[1].read_bytes())
    page.goto(f"/#/sites/{site_id}/surveys/{survey_id}")
    tries: list[str] = []

    def lose_the_first(route: Route) -> None:
        tries.append(route.request.url)
        route.abort() if len(tries) == 1 else route.continue_()

    page.route(re.compile(r"/images/IMG_0000\.jpg$"), lambda route: lose_the_first(route))
    drop_photos(page, [PHOTOS[0], broken])
    uploads = page.get_by_role("status", name="Uploads")
    expect(uploads.get_by_text("1 of 2 photographs")).to_be_visible()
    assert len(tries) == 2
    expect(uploads.get_by_text("refused")).to_be_visible()
    expect(uploads.get_by_text("no readable image")).to_be_visible()
    drop_photos(page, [renamed])
    uploads.get_by_role("button", name="Send as IMG_0000 (2).jpg").click()
    expect(page.get_by_role("link", name="IMG_0000 (2).jpg")).to_be_visible()


def test_control_points_are_checked_as_they_are_pasted(page: Page, web_served: Served) -> None:
    survey_id = web_served.new_survey(web_served.new_site(name="Points"))
    site_id = web_served.client.get(f"/surveys/{survey_id}").json()["site_id"]
    page.goto(f"/#/sites/{site_id}/surveys/{survey_id}")
    part = points_part(page)
    expect(part.get_by_text("Without control points the map is free")).to_be_visible()
    paste(page, "P1\t16925\tA\t1,5\t2\t3\nP2\t152325\tQ\t1\tx\t3\nP1\t16925\tA\t0\t0\t0\n")
    expect(page.get_by_label("x_m of row 1")).to_have_value("1.5")
    for told in ('"Q" is none of A', '"x" is no number', '"P1" stands in row 1 too', "dot A of code 16925 stands"):
        expect(part.get_by_text(told)).to_be_visible()
    page.get_by_role("button", name="Clear").click()
    paste(page, "P1,16925,A,0,0,1\nP2,152325,B,1,0,1\nP3,115559,C,2,0,1")
    expect(part.get_by_text("are in one line")).to_be_visible()
    page.get_by_label("y_m of row 3").fill("2")
    expect(part.get_by_text("show no blunder")).to_be_visible()
    # What is typed while the points before it are being stored stays, and is said not to be stored.
    storing: list[Route] = []
    page.route("**/control-points", lambda route: storing.append(route) if is_put(route) else route.continue_())
    with page.expect_request(lambda request: request.method == "PUT"):
        page.get_by_role("button", name="Save the points").click()
    page.get_by_role("button", name="Add a point").click()
    page.get_by_label("name of row 4").fill("P4")
    with page.expect_response(lambda answer: answer.request.method == "GET" and "control-points" in answer.url):
        storing.pop().continue_()
    expect(page.get_by_label("name of row 4")).to_have_value("P4")
    expect(part.get_by_role("status").filter(has_text="saved")).to_have_text("not saved yet")
    page.get_by_label("Remove row 4").click()
    expect(part.get_by_role("status").filter(has_text="saved")).to_have_text("saved")


def is_put(route: Route) -> bool:
    return route.request.method == "PUT"


def test_the_page_knows_the_codes_of_each_family(page: Page, web_room: Room) -> None:  # noqa: ARG001 - a page to be on
    page.goto("/")
    script = """async ([family, codes]) => {
      const { familyHolds } = await import("/assets/survey/families.js");
      return codes.filter((code) => familyHolds(family, code));
    }"""
    tried = list(range(0, 177_147, 13))
    for name in ("golay", "hamming", "parity", "full"):
        family = family_by_name(name)
        tried_here = tried + family.codes[:50].tolist()
        assert page.evaluate(script, [name, tried_here]) == [code for code in tried_here if family.contains(code)]
