"""Work that is interrupted, by a key that runs out, a full server, a reload, no network, and goes on."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from tests.api.guarding import Guarded, serve_guarded
from tests.api.serving import ROOM, Served
from tests.web.conftest import watched_context

PHOTOGRAPHS = sorted((ROOM / "survey").glob("*.jpg"))[:3]


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Guarded]:
    with serve_guarded(tmp_path_factory.mktemp("guarded")) as running:
        yield running


def test_work_waits_for_another_key(chromium: Browser, guarded: Guarded) -> None:
    site_id = guarded.new_site(name="Hall")
    survey_id = guarded.new_survey(site_id, note="first")
    key = guarded.new_key("survey", "analyse")
    context, watched = watched_context(chromium, guarded)
    context.request.post("/session", data={"key": key["secret"]})
    page = context.new_page()
    page.goto(f"/#/sites/{site_id}/surveys/{survey_id}")
    page.get_by_role("button", name="Add a point").click()
    page.get_by_label("name of row 1").fill("P1")
    assert guarded.client.delete(f"/keys/{key['key_id']}").status_code == 200
    page.get_by_label("Choose photographs").first.set_input_files(PHOTOGRAPHS)
    dialog = page.get_by_role("dialog", name="Key needed")
    expect(dialog.get_by_label("Key", exact=True)).to_be_focused()  # one may type at once
    dialog.get_by_label("Key", exact=True).fill("no key at all")
    page.keyboard.press("Enter")
    expect(dialog.get_by_role("alert")).to_be_visible()
    dialog.get_by_label("Key", exact=True).fill(guarded.new_key("survey", "analyse")["secret"])
    page.keyboard.press("Enter")
    expect(dialog).to_have_count(0)
    expect(page.get_by_role("list", name="Photographs of the survey").get_by_role("listitem")).to_have_count(3)
    expect(page.get_by_label("name of row 1")).to_have_value("P1")
    context.close()
    assert not watched.faults


def test_a_full_server_is_asked_again_and_nothing_typed_is_lost(page: Page, web_served: Served) -> None:
    site_id = web_served.new_site(name="Hall")
    survey_id = web_served.new_survey(site_id, note="Second floor")
    asked: list[str] = []
    page.route(f"**/surveys/{survey_id}", lambda route: full_at_first(route, asked))
    page.goto(f"/#/sites/{site_id}/surveys/{survey_id}")
    expect(page.get_by_text("it is asked again in a moment")).to_be_visible()
    expect(page.get_by_role("heading", name="Second floor")).to_be_visible()
    assert len(asked) == 2
    page.get_by_role("button", name="Add a point").click()
    page.get_by_label("name of row 1").fill("P1")
    page.reload()
    expect(page.get_by_label("name of row 1")).to_have_value("P1")
    expect(page.get_by_text("not saved yet")).to_be_visible()
    page.get_by_role("button", name="Clear").click()
    page.reload()
    expect(page.get_by_role("button", name="Add a point")).to_be_visible()
    expect(page.get_by_label("name of row 1")).to_have_count(0)
    page.context.set_offline(True)
    page.get_by_role("link", name="Report", exact=True).click()  # its code is not here yet
    expect(page.get_by_role("alert")).to_contain_text("The server cannot be reached")
    page.context.set_offline(False)
    page.get_by_role("button", name="Try again").click()
    expect(page.get_by_text("No target map yet.")).to_be_visible()


def full_at_first(route: Route, asked: list[str]) -> None:
    asked.append(route.request.url)
    if len(asked) > 1:
        return route.continue_()
    problem = {"type": "/problems/overloaded", "detail": "the queue is full", "retry_after_s": 1}
    return route.fulfill(status=503, json=problem, content_type="application/problem+json")
