"""What the operator sees: health, jobs, storage, keys, audit; and the door where a key is shown."""

from collections.abc import Iterator

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from tests.api.guarding import ADMIN_SECRET, Guarded, serve_guarded
from tests.api.serving import Served
from tests.web.conftest import watched_context
from tests.web.prebuilt import Room


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Guarded]:
    with serve_guarded(tmp_path_factory.mktemp("guarded")) as running:
        yield running


@pytest.fixture
def visitor(chromium: Browser, guarded: Guarded) -> Iterator[Page]:
    context, watched = watched_context(chromium, guarded)
    yield context.new_page()
    context.close()
    assert not watched.faults


def sign_in(page: Page, key: str) -> None:
    page.get_by_label("Key").fill(key)
    page.get_by_role("button", name="Sign in").click()


def test_a_key_opens_the_pages_makes_another_and_revokes_it(visitor: Page, guarded: Guarded) -> None:
    visitor.goto("/#/operator?part=keys")
    sign_in(visitor, "sm_wrong")
    expect(visitor.get_by_role("alert")).to_contain_text("unknown, expired or revoked")
    sign_in(visitor, ADMIN_SECRET)
    visitor.get_by_role("button", name="New key").click()
    dialog = visitor.get_by_role("dialog")
    dialog.get_by_label("Name").fill("Corridor phone")
    dialog.get_by_role("button", name="Make the key").click()
    secret = visitor.get_by_test_id("secret").inner_text()
    answer = guarded.client.get("/session", headers={"Authorization": f"Bearer {secret}"})
    assert answer.json()["scopes"] == ["locate"]
    visitor.get_by_role("button", name="Close").click()
    row = visitor.get_by_role("row").filter(has_text="Corridor phone")
    expect(row).to_contain_text("valid")
    row.get_by_role("button", name="Revoke Corridor phone").click()
    visitor.get_by_role("button", name="Revoke it").click()
    expect(row).to_contain_text("revoked")
    visitor.get_by_role("link", name="Audit").click()
    expect(visitor.get_by_role("region", name="Audit")).to_contain_text("POST /keys")
    visitor.get_by_role("button", name="Sign out").click()
    expect(visitor.get_by_role("heading", name="Key needed")).to_be_visible()


def test_health_jobs_and_storage_of_a_running_service(page: Page, web_room: Room, web_served: Served) -> None:
    page.goto("/#/operator")
    expect(page.get_by_role("heading", name="This server is")).to_contain_text("ready")
    page.get_by_role("link", name="Storage").click()
    row = page.get_by_role("row").filter(has=page.locator(f'a[href="#/sites/{web_room.site_id}"]'))
    expect(row).to_contain_text("Demonstration room")
    expect(row).to_contain_text("16")
    survey_id = web_served.new_survey(web_served.new_site(name="Empty"))
    for shade in (90, 110):
        wall = np.full((240, 320, 3), shade, dtype=np.uint8)
        jpeg = cv2.imencode(".jpg", wall)[1].tobytes()
        assert web_served.put_photo(survey_id, f"wall-{shade}.jpg", jpeg).status_code == 201
    failed = web_served.build(survey_id)
    assert failed["state"] == "failed"
    page.get_by_role("link", name="Jobs", exact=True).click()
    row = page.get_by_role("row").filter(has_text=failed["error"]["detail"][:40])
    expect(row.first).to_contain_text("failed")
    with page.expect_response(lambda answer: answer.url.endswith(f"/jobs/{failed['job_id']}/retry")):
        row.first.get_by_role("button", name="Try again").click()
    assert web_served.wait(failed["job_id"])["finished_at"] > failed["finished_at"]
    expect(row.first).to_contain_text("failed")
