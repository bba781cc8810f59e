"""The list of sites, a new one, its sheets."""

from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.api.serving import Served
from tests.web.prebuilt import Room


def test_a_site_is_made_named_and_deleted(page: Page) -> None:
    page.goto("/")
    page.get_by_role("button", name="New site").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Name").fill("Lecture hall")
    dialog.get_by_label("Module u").fill("20")
    dialog.get_by_role("button", name="Make the site").click()
    expect(page.get_by_role("heading", name="Lecture hall")).to_be_visible()
    expect(page.get_by_text("plates of 260 mm")).to_be_visible()
    page.get_by_role("button", name="Rename").click()
    page.get_by_role("dialog").get_by_label("Name").fill("Great hall")
    page.get_by_role("dialog").get_by_role("button", name="Rename").click()
    expect(page.get_by_role("heading", name="Great hall")).to_be_visible()
    page.get_by_role("button", name="Delete").click()
    sure = page.get_by_role("dialog")
    expect(sure.get_by_role("button", name="Delete for good")).to_be_disabled()
    sure.get_by_role("textbox").fill("Great hall")
    sure.get_by_role("button", name="Delete for good").click()
    expect(page.get_by_role("heading", name="Sites")).to_be_visible()
    expect(page.get_by_role("link", name="Great hall")).to_have_count(0)


def test_sheets_are_downloaded(page: Page, web_served: Served, tmp_path: Path) -> None:
    site_id = web_served.new_site(name="Sheets")
    page.goto(f"/#/sites/{site_id}")
    page.get_by_label("How many").fill("2")
    page.get_by_label("Paper").select_option("A5")
    with page.expect_download() as download:
        # The plates of this site are for A4.
        page.get_by_role("button", name="Make the sheets").click()
        expect(page.get_by_role("alert")).to_contain_text("too large for A5")
        page.get_by_label("Paper").select_option("A4")
        page.get_by_role("button", name="Make the sheets").click()
    download.value.save_as(tmp_path / "sheets.pdf")
    assert (tmp_path / "sheets.pdf").read_bytes().startswith(b"%PDF")


def test_the_list_shows_which_sites_have_a_map(page: Page, web_room: Room) -> None:
    page.goto("/")
    row = page.get_by_role("row").filter(has=page.locator(f'a[href="#/sites/{web_room.site_id}"]'))
    expect(row.get_by_text("version 1")).to_be_visible()


@pytest.mark.parametrize("address", ["/#/nowhere", "/#/sites/none/nowhere"])
def test_an_address_without_a_page_says_so(page: Page, address: str) -> None:
    page.goto(address)
    expect(page.get_by_text("There is no such page")).to_be_visible()


def test_a_site_that_is_not_there_says_so(page: Page) -> None:
    page.goto("/#/sites/none")
    expect(page.get_by_role("alert")).to_contain_text("none")


def test_colours_follow_the_reader(page: Page) -> None:
    page.emulate_media(color_scheme="dark")
    page.goto("/")
    page.get_by_role("button", name="Colours: Auto").click()
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")
    page.get_by_role("button", name="Colours: Dark").click()
    expect(page.locator("html")).to_have_css("background-color", "rgb(255, 255, 255)")
