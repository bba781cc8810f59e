"""Hands on photographs and plans: two fingers zoom about their middle, one drags, the wheel zooms at the pointer."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from tests.api.serving import Served
from tests.web.conftest import watched_context
from tests.web.prebuilt import Room
from tests.web.waiting import FRAMED, await_drawn, wait_until

Point = tuple[float, float]
STEPS = 5
NEAR = 0.02  # of the seen part: fingers stand on whole pixels
FINGER_PX = 2.0
WHEEL = 0.0015  # of a zoom, for each pixel of the wheel (plan/hands.js)
PLATE_LINE_PX = 3  # no other line of a plan is as broad (plan/draw.js)
# Where a plan draws a corner of each of its plates.
WATCH_PLATES = f"""() => {{ window.plates = []; const move = CanvasRenderingContext2D.prototype.moveTo;
  CanvasRenderingContext2D.prototype.moveTo = function (x, y) {{
    if (this.lineWidth === {PLATE_LINE_PX}) window.plates.push([x, y]); return move.call(this, x, y); }}; }}"""


@pytest.fixture
def touched(chromium: Browser, web_served: Served) -> Iterator[Page]:
    context, watched = watched_context(chromium, web_served, has_touch=True)
    yield context.new_page()
    context.close()
    assert not watched.faults


def move_fingers(page: Page, start: list[Point], end: list[Point]) -> None:
    """All fingers down, from here to there, and up."""
    session = page.context.new_cdp_session(page)
    for step in range(STEPS + 1):
        share = step / STEPS
        points = [
            {"x": a[0] + share * (b[0] - a[0]), "y": a[1] + share * (b[1] - a[1]), "id": finger}
            for finger, (a, b) in enumerate(zip(start, end, strict=True))
        ]
        kind = "touchMove" if step else "touchStart"
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    await_drawn(page)


def middle_of(surface: Locator) -> tuple[Point, Point]:
    """The middle of an element on the screen, and its left upper corner."""
    box = surface.bounding_box()
    assert box
    return (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2), (box["x"], box["y"])


def seen(surface: Locator) -> list[float]:
    return [float(part) for part in (surface.get_attribute("viewBox") or "").split()]


def test_two_fingers_zoom_a_photograph_about_their_middle_and_one_drags_it(touched: Page, web_room: Room) -> None:
    touched.goto(f"/#/sites/{web_room.site_id}/surveys/{web_room.survey_id}/photos/IMG_0000.jpg")
    surface = touched.get_by_role("application")
    expect(touched.get_by_role("button", name="Mark in the photograph")).to_be_visible()
    wait_until(touched, FRAMED)
    surface.scroll_into_view_if_needed()
    (x, y), (left, top) = middle_of(surface)
    x, y = round(x + 60), round(y - 40)
    whole = seen(surface)
    box = surface.bounding_box()
    assert box
    shares = ((x - left) / box["width"], (y - top) / box["height"])
    at = [whole[axis] + share * whole[2 + axis] for axis, share in enumerate(shares)]
    move_fingers(touched, [(x - 30, y), (x + 30, y)], [(x - 90, y), (x + 90, y)])
    expect(surface).not_to_have_attribute("viewBox", " ".join(map(str, whole)))
    close = seen(surface)
    assert whole[2] / close[2] == pytest.approx(3.0, rel=NEAR)
    now = [close[axis] + share * close[2 + axis] for axis, share in enumerate(shares)]
    for before, after, side in zip(at, now, close[2:], strict=True):
        assert after == pytest.approx(before, abs=NEAR * side)
    move_fingers(touched, [(x, y)], [(x + 50, y + 20)])
    moved = seen(surface)
    scale = close[2] / box["width"]
    # A finger's first pixels may have been meant as a touch.
    assert close[0] - moved[0] == pytest.approx(50 * scale, abs=12 * scale)
    assert touched.locator(".overlay .picked").count() == 0


def places(page: Page, change: Callable[[], None]) -> list[Point]:
    """Where a plan draws its plates once something has changed it for the last time."""
    change()
    await_drawn(page)
    page.evaluate("() => { window.plates = []; }")
    page.get_by_label("Plan of").dispatch_event("wheel", {"deltaY": 0})  # draws what is seen anew
    wait_until(page, "() => window.plates.length > 0")
    found: list[Point] = page.evaluate("() => window.plates")
    return found


def zoomed(points: list[Point], factor: float, about: Point) -> list[Point]:
    """Points that went away from a middle by a factor."""
    return [(about[0] + factor * (x - about[0]), about[1] + factor * (y - about[1])) for x, y in points]


def assert_near(found: list[Point], expected: list[Point]) -> None:
    assert len(found) > 3
    for seen_at, expected_at in zip(found, expected, strict=True):
        assert seen_at == pytest.approx(expected_at, abs=FINGER_PX)


def test_fingers_and_wheel_on_a_plan(touched: Page, web_room: Room) -> None:
    touched.goto(f"/#/trajectories/{web_room.trajectory_id}")
    plan = touched.get_by_label(re.compile("Plan of"))
    expect(plan).to_be_visible()
    touched.evaluate(WATCH_PLATES)
    plan.focus()
    plan.scroll_into_view_if_needed()
    (x, y), (left, top) = middle_of(plan)
    x, y = round(x), round(y)
    about = (x - left, y - top)
    whole = places(touched, lambda: plan.press("0"))
    apart = [(x - 45, y), (x + 45, y)]
    pinched = places(touched, lambda: move_fingers(touched, [(x - 30, y), (x + 30, y)], apart))
    assert_near(pinched, zoomed(whole, 1.5, about))
    dragged = places(touched, lambda: move_fingers(touched, [(x, y)], [(x + 40, y - 30)]))
    assert_near(dragged, [(plate_x + 40, plate_y - 30) for plate_x, plate_y in pinched])
    fitted = places(touched, lambda: plan.press("0"))
    touched.mouse.move(x - 100, y + 50)
    wheeled = places(touched, lambda: touched.mouse.wheel(0, -200))
    assert_near(wheeled, zoomed(fitted, math.exp(200 * WHEEL), (about[0] - 100, about[1] + 50)))


def test_two_fingers_come_closer_in_the_room(touched: Page, web_room: Room) -> None:
    touched.goto(f"/#/sites/{web_room.site_id}/room")
    canvas = touched.locator("canvas[data-draw-calls]")
    expect(canvas).to_be_visible()
    canvas.scroll_into_view_if_needed()
    (x, y), _ = middle_of(canvas)
    away_m = float(canvas.get_attribute("data-away") or "nan")
    move_fingers(touched, [(x - 30, y), (x + 30, y)], [(x - 90, y), (x + 90, y)])
    closer_m = float(canvas.get_attribute("data-away") or "nan")
    assert away_m / closer_m == pytest.approx(3.0, rel=NEAR)
    before = canvas.screenshot()
    move_fingers(touched, [(x, y)], [(x + 60, y)])
    assert canvas.screenshot() != before  # one finger turns it
    assert float(canvas.get_attribute("data-away") or "nan") == pytest.approx(closer_m)
