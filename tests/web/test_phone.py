"""The phone: a camera that plays photographs of the demonstration room, located once, in runs, without a network."""

from __future__ import annotations

import io
import json
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, BrowserContext, Page, Request, Route, expect, sync_playwright

from tests.api.guarding import Guarded, serve_guarded
from tests.api.serving import ROOM, Served, room_photos
from tests.web.chromium import ARGUMENTS, find_chromium
from tests.web.conftest import Watched, watched_context
from tests.web.filmed import fake_camera, film
from tests.web.prebuilt import Room, surveyed_room
from tests.web.screenshots import keep_screenshot
from tests.web.waiting import wait_until

FILMED = ("IMG_0000.jpg", "IMG_0004.jpg", "IMG_0006.jpg", "IMG_0008.jpg", "IMG_0010.jpg", "IMG_0012.jpg")
BERLIN_S = 1795165204.5  # 2026-11-20T09:00:04.5Z
PHONE = {"width": 360, "height": 740}
SIGMAS = 4.5  # of each coordinate: one of a hundred thousand is beyond
ROUNDING_M = 0.0005  # of what is shown
ELSEWHERE = "phone.test"  # a name that leads to this machine, and no secure page
ACCENT_RGB = [11, 87, 164]  # of style/tokens.css, light

# The colour in the middle of where the plan must show a position among its targets.
COLOUR_AT = """async ([targets, here]) => {
  const { boundsOf, fitted, pixelsOf } = await import("/assets/plan/view.js");
  const canvas = document.querySelector(".plan canvas");
  const [toX, toY] = pixelsOf(fitted(boundsOf([here, ...targets]), canvas.clientWidth, canvas.clientHeight));
  const at = [toX(here[0]), toY(here[1])].map((value) => Math.round(value * devicePixelRatio));
  return [...canvas.getContext("2d").getImageData(...at, 1, 1).data.slice(0, 3)]; }"""
SHOWN_AT = f"async (given) => String(await ({COLOUR_AT})(given)) === '{','.join(map(str, ACCENT_RGB))}'"
SOME = re.compile(r"^([3-9]|\d\d+)$")  # pictures of a run: it goes on while one looks
# The phone reads files slowly: until it is told to go on.
READ_SLOWLY = """() => {
  const read = Blob.prototype.arrayBuffer, allowed = new Promise((allow) => { window.readOn = allow; });
  Blob.prototype.arrayBuffer = function () { return allowed.then(() => read.call(this)); }; }"""
DEVICE = "() => localStorage.getItem('scattermark:device')"


@pytest.fixture(scope="module")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """A browser whose camera plays a walk through the room."""
    walk = film((ROOM / "locate" / name for name in FILMED), tmp_path_factory.mktemp("film") / "walk.y4m")
    arguments = [*ARGUMENTS, *fake_camera(walk), f"--host-resolver-rules=MAP {ELSEWHERE} 127.0.0.1"]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=arguments)
        yield browser
        browser.close()


@dataclass
class Phone:
    """A phone in the room."""

    context: BrowserContext
    served: Served
    room: Room

    def open(self, address: str = "") -> Page:
        page = self.context.new_page()
        page.set_viewport_size(PHONE)  # type: ignore[arg-type]
        page.goto(address or f"/#/sites/{self.room.site_id}/phone")
        return page

    def trajectories(self, page: Page, **wanted: Any) -> list[dict[str, Any]]:
        """What the service has of this phone."""
        device_id = page.evaluate(DEVICE)
        asked = {"site_id": self.room.site_id, "device_id": device_id, **wanted}
        listed = self.served.client.get("/trajectories", params=asked).json()["trajectories"]
        return [self.served.client.get(f"/trajectories/{item['trajectory_id']}").json() for item in listed]


@contextmanager
def a_phone(browser: Browser, served: Served, room: Room, **options: Any) -> Iterator[Phone]:
    given = {"permissions": ["camera"], "device_scale_factor": 2, "has_touch": True, **options}
    context, watched = watched_context(browser, served, **given)
    context.on("request", lambda request: _watch_worker(watched, request))
    yield Phone(context, served, room)
    context.close()
    assert not watched.faults


def _watch_worker(watched: Watched, request: Request) -> None:
    """What the service worker asks for belongs to no page."""
    if request.service_worker is not None:
        watched.on_request(request)


@pytest.fixture
def phone(chromium: Browser, web_served: Served, web_room: Room) -> Iterator[Phone]:
    with a_phone(chromium, web_served, web_room) as ready:
        yield ready


def true_positions_m() -> np.ndarray:
    shots = json.loads((ROOM / "locate" / "truth.json").read_text())["shots"]
    return np.array([shot["position_m"] for shot in shots if shot["file"] in FILMED])


def assert_true(position_m: Any, sigma_m: Any, rounding_m: float = 0.0) -> None:
    """The position is that of a photograph of the film, as well as its sigmas say."""
    errors = np.abs(true_positions_m() - position_m)
    assert np.any(np.all(errors <= SIGMAS * np.array(sigma_m) + rounding_m, axis=1)), (position_m, sigma_m)


def shown_position(page: Page) -> tuple[list[float], list[float]]:
    """Metres and sigmas that stand on the page."""
    read = page.locator(".phone-position")
    position_m = [float(text) for text in read.locator("b").all_inner_texts()]
    sigma_mm = [float(text.strip("± m")) for text in read.locator("span").all_inner_texts()]
    return position_m, [value / 1000 for value in sigma_mm]


def counted(page: Page, name: str) -> Any:
    return page.locator(".phone-counts div").filter(has_text=name).locator("dd")


def queue_of(page: Page) -> Any:
    return page.get_by_role("region", name="Queue")


def settings_of(page: Page) -> Any:
    page.get_by_text("Camera, clock, this phone").click()
    return page.locator(".phone-settings")


def test_one_button_tells_where_one_is(phone: Phone) -> None:
    page = phone.open()
    settings = settings_of(page)
    expect(settings).to_contain_text(re.compile(r"Clock offset\s*[+\u2212][\d.]+ ms ± [\d.]+ ms"))
    expect(settings.get_by_role("link", name="Calibrate this camera")).to_be_visible()
    (camera,) = phone.served.client.get("/cameras", params={"site_id": phone.room.site_id}).json()["cameras"]
    settings.get_by_label("Camera record").select_option(camera["camera_id"])
    page.get_by_role("button", name="Locate", exact=True).click()
    answer = page.get_by_role("region", name="Position")
    expect(answer).to_contain_text("camera: as the survey found it")
    position_m, sigma_m = shown_position(page)
    assert_true(position_m, sigma_m, ROUNDING_M)
    expect(answer).to_contain_text(re.compile(r"Heading -?[\d.]+° ± [\d.]+°"))
    (kept,) = phone.trajectories(page)
    (pose,) = kept["poses"]
    np.testing.assert_allclose(position_m, pose["position_m"], atol=ROUNDING_M)
    assert pose["clock_delay_s"] < 60 and abs(time.time() - kept_s(pose)) < 300
    targets = phone.served.client.get(f"/sites/{phone.room.site_id}/targets").json()["targets"]
    wait_until(page, SHOWN_AT, [[target["position_m"] for target in targets], pose["position_m"]])
    page.set_viewport_size({**PHONE, "height": 1010})  # the whole plan with it
    keep_screenshot(page, "phone")
    page.reload()  # the choice stays, and so does what was found
    expect(answer).to_contain_text("camera: as the survey found it")
    expect(settings_of(page).get_by_label("Camera record")).to_have_value(camera["camera_id"])


def kept_s(pose: dict[str, Any]) -> float:
    return float(np.datetime64(pose["captured_at"].rstrip("Z")).astype("datetime64[us]").astype(np.int64) / 1e6)


def test_a_run_becomes_a_trajectory(phone: Phone) -> None:
    page = phone.open()
    page.get_by_label("Every, s").fill("0.5")
    page.get_by_label("Name", exact=True).fill("Through the hall")
    begun_s = time.time()
    start = page.get_by_role("button", name="Start run")
    expect(start).to_be_enabled()  # the camera is there
    start.evaluate("button => { button.click(); button.click(); }")  # one run
    expect(counted(page, "located")).to_have_text(re.compile(r"^([4-9]|\d\d+)$"))
    page.get_by_role("button", name="End run").click()
    expect(page.get_by_role("button", name="Start run")).to_be_visible()  # the end is in the queue
    expect(queue_of(page)).to_contain_text("Nothing waits")
    ended_s = time.time()
    (walk,) = phone.trajectories(page)
    assert walk["name"] == "Through the hall" and walk["closed_at"] is not None
    assert walk["pose_count"] >= 4 and walk["failure_count"] == 0
    times_s = np.array([kept_s(pose) for pose in walk["poses"]])
    assert np.all((times_s >= begun_s - 1) & (times_s <= ended_s))
    assert np.all(np.diff(times_s) > 0)  # each frame is another one
    for pose in walk["poses"]:
        assert_true(pose["position_m"], pose["position_sigma_m"])


def test_pictures_wait_for_the_network(phone: Phone) -> None:
    page = phone.open()
    expect(settings_of(page)).to_contain_text("yes: pictures queue")
    phone.context.set_offline(True)
    begun_s = time.time()
    page.get_by_role("button", name="Start run").click()
    expect(counted(page, "waiting")).to_have_text(SOME)
    page.get_by_role("button", name="Pause").click()
    expect(queue_of(page).get_by_text("offline")).to_be_visible()
    page.close()
    closed_s = time.time()
    again = phone.open()  # the pages' files are on the phone
    expect(again.get_by_text("No network")).to_be_visible()
    expect(again.get_by_role("button", name="Go on")).to_be_enabled()
    expect(counted(again, "waiting")).to_have_text(SOME)
    waiting = int(counted(again, "waiting").inner_text())
    again.get_by_role("button", name="End run").click()
    expect(again.get_by_role("button", name="Start run")).to_be_visible()
    lost: list[str] = []
    phone.context.route("**/locate", lambda route: lose_the_first_answer(route, lost))
    phone.context.set_offline(False)
    expect(queue_of(again)).to_contain_text("Nothing waits")
    expect(again.get_by_text("No network")).to_have_count(0)
    assert_newest_is_shown(again)
    (walk,) = phone.trajectories(again)
    assert lost and walk["closed_at"] is not None
    assert walk["pose_count"] + walk["failure_count"] == waiting
    assert len({pose["snapshot_id"] for pose in walk["poses"]}) == walk["pose_count"]
    assert all(begun_s - 1 <= kept_s(pose) <= closed_s for pose in walk["poses"])


def assert_newest_is_shown(page: Page) -> None:
    """With a network its word counts, not what the service worker keeps."""
    page.context.route("**/assets/icon.svg", lambda route: route.fulfill(body="newer"))
    assert page.evaluate("fetch('/assets/icon.svg').then((answer) => answer.text())") == "newer"


def lose_the_first_answer(route: Route, lost: list[str]) -> None:
    """The service keeps the picture; the phone hears nothing of it and sends it again."""
    if lost:
        return route.continue_()
    route.fetch()
    lost.append(route.request.url)
    return route.abort()


def test_photographs_bring_their_own_time_and_refusals_say_what_to_do(
    chromium: Browser, web_served: Served, web_room: Room
) -> None:
    with a_phone(chromium, web_served, web_room, timezone_id="Europe/Berlin") as phone:
        page = phone.open()
        files = page.get_by_label("Photographs to locate")
        photograph = room_photos("locate")["IMG_0004.jpg"]
        files.set_input_files([photo("IMG_0004.jpg", photograph)])
        answer = page.get_by_role("region", name="Position")
        expect(answer.locator(".phone-position")).to_be_visible()
        assert_true(*shown_position(page), ROUNDING_M)
        (kept,) = phone.trajectories(page)
        (pose,) = kept["poses"]
        # 10:00:04 of EXIF, in Berlin, and some part of a second; by the clock of the service
        assert abs(kept_s(pose) - BERLIN_S) <= pose["clock_delay_s"]
        files.set_input_files([photo("dark.jpg", jpeg(Image.new("RGB", (640, 360))))])
        expect(answer).to_contain_text("0 targets seen: turn towards the targets")
        expect(answer).to_contain_text("No target was found in the photograph")  # the service's own words
        cut = Image.open(io.BytesIO(photograph)).crop((160, 0, 1120, 720))
        files.set_input_files([photo("cut.jpg", jpeg(cut))])
        expect(answer).to_contain_text(re.compile(r"\d+ targets seen, but this camera is not known"))
        link = answer.get_by_role("link", name="Calibrate this camera")
        expect(link).to_have_attribute("href", f"#/sites/{web_room.site_id}/phone/calibration")
        (kept,) = phone.trajectories(page)
        assert kept["failures_by_reason"] == {"no-targets": 1, "unknown-camera": 1}


def photo(name: str, data: bytes) -> Any:
    return {"name": name, "mimeType": "image/jpeg", "buffer": data}


def jpeg(picture: Image.Image) -> bytes:
    buffer = io.BytesIO()
    picture.save(buffer, "JPEG", quality=95)
    return buffer.getvalue()


def test_waiting_pictures_are_discarded_after_a_question(phone: Phone) -> None:
    page = phone.open()
    expect(page.get_by_role("button", name="Locate", exact=True)).to_be_enabled()
    phone.context.set_offline(True)
    page.get_by_role("button", name="Locate", exact=True).click()
    queue = queue_of(page)
    expect(queue).to_contain_text("1 picture waiting")
    page.evaluate(READ_SLOWLY)
    for name in ("first.jpg", "second.jpg"):  # the second is chosen while the first is read
        page.get_by_label("Photographs to locate").set_input_files([photo(name, jpeg(Image.new("RGB", (64, 48))))])
    page.evaluate("readOn()")
    expect(queue).to_contain_text("3 pictures waiting")
    queue.get_by_role("button", name="Discard").click()
    page.get_by_role("dialog").get_by_role("button", name="Discard for good").click()
    expect(queue).to_contain_text("Nothing waits")
    phone.context.set_offline(False)
    assert phone.trajectories(page) == []


@pytest.fixture(scope="module")
def guarded(web_room: Room, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Guarded, Room]]:
    """The room on a service that asks for keys."""
    with serve_guarded(tmp_path_factory.mktemp("guarded"), allowed_hosts=ELSEWHERE) as running:
        room = surveyed_room(running, tmp_path_factory)
        assert room == web_room  # of the same archive: this service builds nothing
        yield running, room


def test_a_link_with_a_key_opens_the_page(chromium: Browser, guarded: tuple[Guarded, Room]) -> None:
    served, room = guarded
    key = served.new_key("locate", site_ids=[room.site_id])
    with a_phone(chromium, served, room) as phone:
        page = phone.open(f"/#site_id={room.site_id}&key={key['secret']}")
        page.get_by_role("button", name="Locate", exact=True).click()
        expect(page.locator(".phone-position")).to_be_visible()
        assert key["secret"] not in page.url
        expect(page.get_by_role("link", name="Surveys")).to_have_count(0)
        assert served.client.delete(f"/keys/{key['key_id']}").status_code == 200
        page.get_by_role("button", name="Locate", exact=True).click()  # the picture waits until there is a key
        expect(page.get_by_role("heading", name="Key needed")).to_be_visible()
        page.get_by_label("Key", exact=True).fill(served.new_key("locate", site_ids=[room.site_id])["secret"])
        page.get_by_role("button", name="Sign in").click()
        expect(queue_of(page)).to_contain_text("Nothing waits")
        (kept,) = phone.trajectories(page)
        assert kept["pose_count"] == 2


def test_a_camera_is_calibrated_by_what_it_films(chromium: Browser, web_served: Served, web_room: Room) -> None:
    with a_phone(chromium, web_served, web_room) as phone:
        page = phone.open(f"/#/sites/{web_room.site_id}/phone/calibration")
        page.get_by_role("button", name="Use the live camera").click()
        taken = page.get_by_role("list", name="Photographs of the set").get_by_role("listitem")
        take = page.get_by_role("button", name="Take this picture")
        uploads = page.get_by_role("status", name="Uploads")
        stored = 0
        while stored < 5:  # the camera stays open, and a frame that is taken twice is kept once
            take.click()
            expect(uploads).to_contain_text(re.compile(r"^\s*(\d+) of \1 "))
            done, there = re.findall(r"^\s*(\d+) of.*?photographs?(?: \((\d+) w)?", uploads.inner_text())[0]
            stored = int(done) - int(there or 0)
        expect(taken.filter(has_text="target")).to_have_count(5)
        page.get_by_label("Phone's name").fill("filmed")
        page.get_by_role("button", name="Calibrate with 5 photographs").click()
        expect(page.get_by_text("snapshots of filmed are located with it")).to_be_visible()
        (camera,) = web_served.client.get("/cameras", params={"device_id": "filmed"}).json()["cameras"]
        listed = web_served.client.get("/cameras", params={"site_id": web_room.site_id}).json()["cameras"]
        (known,) = [one for one in listed if one["source"] == "survey"]
        assert abs(camera["fx"] - known["fx"]) < SIGMAS * np.hypot(camera["sigmas"]["fx"], known["sigmas"]["fx"])
        web_served.client.delete(f"/cameras/{camera['camera_id']}")


def test_without_leave_it_says_what_to_do(chromium: Browser, web_served: Served, web_room: Room) -> None:
    with a_phone(chromium, web_served, web_room, permissions=[]) as phone:
        page = phone.open()
        expect(page.get_by_text("This page may not use the camera.")).to_be_visible()
        expect(page.get_by_role("button", name="Locate", exact=True)).to_be_disabled()


def test_a_page_that_is_not_secure_says_so_and_takes_files(chromium: Browser, guarded: tuple[Guarded, Room]) -> None:
    served, room = guarded
    key = served.new_key("locate", site_ids=[room.site_id])["secret"]
    address = str(served.client.base_url).replace("127.0.0.1", ELSEWHERE)
    context = chromium.new_context()
    page = context.new_page()
    page.goto(f"{address}/#site_id={room.site_id}&key={key}")
    expect(page.get_by_text("scattermark serve --lan")).to_be_visible()
    page.get_by_label("Photographs to locate").set_input_files([photo("a.jpg", room_photos("locate")["IMG_0004.jpg"])])
    expect(page.locator(".phone-position")).to_be_visible()
    context.close()
