"""A key that runs out in the midst of work: another one is asked for, and what was being done goes on."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, expect

from tests.api.guarding import Guarded, serve_guarded
from tests.api.serving import ROOM
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
