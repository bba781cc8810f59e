"""The room in three dimensions: what is drawn, what is picked, what it costs; and the same facts without it."""

from collections.abc import Iterator

import numpy as np
import pytest
from playwright.sync_api import Browser, Locator, Page, expect
from scipy.spatial.transform import Rotation

from app.targets.family import family_by_name
from app.trajectories.robotics_formats import tum_text
from app.trajectories.trajectory import Trajectory
from app.vision.detector import detect
from app.vision.photo import load_photo
from tests.api.serving import Served
from tests.api.test_trajectory_import import imported
from tests.web.conftest import watched_context
from tests.web.large_site import PHOTOS, POSES, TARGETS, large_site
from tests.web.prebuilt import Room, surveyed_room
from tests.web.screenshots import keep_screenshot

# Grid, axes, plates, codes, ellipsoids, frusta, points, poses with and without a direction, ring, rays.
STILL_FRAMES = 30
DRAW_CALLS = 11
NO_WEBGL = """const context = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  return kind.startsWith("webgl") ? null : context.call(this, kind, ...rest);
};"""


def drawn(page: Page) -> Locator:
    """The canvas after its first frame."""
    canvas = page.locator("canvas[data-draw-calls]")
    expect(canvas).to_be_visible()
    return canvas


def panel(page: Page) -> Locator:
    return page.get_by_role("region", name="Picked")


@pytest.fixture
def flat_page(chromium: Browser, web_served: Served) -> Iterator[Page]:
    """Of a browser that draws nothing in three dimensions."""
    context, watched = watched_context(chromium, web_served)
    context.add_init_script(NO_WEBGL)
    yield context.new_page()
    context.close()
    assert not watched.faults


def test_a_surveyed_room_is_looked_at_and_picked(page: Page, web_room: Room, web_served: Served) -> None:
    published = web_served.client.get(f"/sites/{web_room.site_id}/targets").json()
    target = published["targets"][5]
    page.goto(f"/#/sites/{web_room.site_id}/room?code={target['code']}")
    canvas = drawn(page)
    facts = panel(page)
    expect(facts.get_by_role("heading", name=f"Target {target['code']}")).to_be_visible()
    for coordinate_m, sigma_m in zip(target["position_m"], target["sigma_m"], strict=True):
        expect(facts).to_contain_text(f"{coordinate_m:.4f} m")
        expect(facts).to_contain_text(f"{1000 * sigma_m:.2f} mm")
    seen_in = facts.get_by_role("listitem")
    expect(seen_in).to_have_count(target["rays"])

    # Brought into the middle, it is what a click there picks again.
    facts.get_by_role("button", name="Look at it").click()
    facts.get_by_role("button", name="Clear").click()
    expect(facts).to_have_count(0)
    page.locator("canvas").scroll_into_view_if_needed()
    canvas.click()
    expect(facts.get_by_role("heading", name=f"Target {target['code']}")).to_be_visible()
    assert f"code={target['code']}" in page.url

    # From the target to a photograph that shows it, and back.
    seen_in.first.get_by_role("button").click()
    expect(facts.get_by_role("heading", name="Photograph")).to_be_visible()
    facts.get_by_role("button", name=str(target["code"]), exact=True).click()
    expect(facts.get_by_role("heading", name=f"Target {target['code']}")).to_be_visible()
    page.get_by_role("button", name="Fit all").click()
    expect(canvas).to_have_attribute("data-view", "room")


def around_the_room() -> Trajectory:
    """A person's walk between the walls, a pose every 0.4 s."""
    t = np.linspace(0.0, 2.0 * np.pi, 60)
    place_m = np.column_stack([2.5 + 1.5 * np.cos(t), 2.0 + 1.1 * np.sin(t), np.full_like(t, 1.5)])
    turned = Rotation.from_euler("zx", np.column_stack([t, np.full_like(t, -np.pi / 2.0)]))  # ahead, and level
    return Trajectory(1_777_600_000.0 + 0.4 * np.arange(len(t)), place_m, turned.as_quat(canonical=True))


def test_the_whole_room_with_a_walk(page: Page, web_served: Served, tmp_path_factory: pytest.TempPathFactory) -> None:
    room = surveyed_room(web_served, tmp_path_factory, as_new=True)
    walk = around_the_room()
    imported(web_served, "".join(tum_text([walk])), site_id=room.site_id, name="walk")
    page.goto(f"/#/sites/{room.site_id}/room")
    canvas = drawn(page)
    page.get_by_role("button", name="Isometric", exact=True).click()
    page.get_by_role("slider", name="Ellipsoids enlarged by").fill("6")
    expect(canvas).to_have_attribute("data-view", "isometric")
    expect(page.get_by_text(f"{len(walk.times_s) + 7} poses")).to_be_visible()
    settled_calls(page)
    keep_screenshot(page, "room")


def settled_calls(page: Page) -> int:
    """Draw calls of a frame once they stay the same over many."""
    counts = [0, 1]
    while len(set(counts)) > 1:
        ask = "() => new Promise(requestAnimationFrame).then(() => document.querySelector('canvas').dataset.drawCalls)"
        counts = [int(page.evaluate(ask)) for _ in range(STILL_FRAMES)]
    return counts[0]


def test_views_layers_ellipsoids_and_the_keyboard(page: Page, web_room: Room) -> None:
    page.goto(f"/#/sites/{web_room.site_id}/room")
    canvas = drawn(page)
    for name in ("Plan", "Isometric", "Walk"):
        page.get_by_role("button", name=name, exact=True).click()
        expect(canvas).to_have_attribute("data-view", name.lower())
    page.get_by_role("button", name="Step forward").click()
    canvas.press("ArrowLeft")
    page.get_by_role("button", name="Room", exact=True).click()
    page.get_by_role("slider", name="Ellipsoids enlarged by").fill("6")
    expect(page.get_by_test_id("scale")).to_contain_text("10 cm in the room are 1.0 mm")
    expect(page.get_by_role("button", name="Poses")).not_to_contain_text("Poses 0")
    layers = [page.get_by_role("checkbox", name=layer) for layer in ("Codes", "Photographs", "Grid and axes")]
    for layer in layers:
        layer.uncheck()
    fewest = settled_calls(page)
    for layer in layers:
        layer.check()
    expect(canvas).to_have_attribute("data-draw-calls", str(fewest + 4))
    assert fewest + 4 <= DRAW_CALLS

    page.get_by_role("button", name="Control points").click()
    row = page.get_by_role("region", name="Control points").get_by_role("row").nth(1)
    row.focus()
    row.press("Enter")
    expect(panel(page)).to_contain_text("Distance")
    page.get_by_role("button", name="Poses").click()
    page.get_by_role("region", name="Poses").get_by_role("row").nth(1).click()
    expect(panel(page)).to_contain_text("Located pose")
    expect(panel(page).get_by_role("link", name="phone")).to_be_visible()


def test_a_hall_and_ten_thousand_poses_take_no_more_draw_calls(page: Page, web_served: Served) -> None:
    page.goto(f"/#/sites/{large_site(web_served)}/room")
    canvas = drawn(page)
    expect(canvas).to_have_attribute("data-instances", str(TARGETS + PHOTOS + POSES))
    assert int(canvas.get_attribute("data-draw-calls") or 0) <= DRAW_CALLS
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(canvas).to_have_attribute("data-view", "plan")
    assert int(canvas.get_attribute("data-draw-calls") or 0) <= DRAW_CALLS
    expect(page.get_by_role("region", name="Targets").get_by_role("row")).to_have_count(TARGETS + 1)


def test_a_plate_on_the_screen_is_read_as_its_code(chromium: Browser, web_served: Served, web_room: Room) -> None:
    target = web_served.client.get(f"/sites/{web_room.site_id}/targets").json()["targets"][5]
    context, watched = watched_context(chromium, web_served, device_scale_factor=2)
    page = context.new_page()
    page.goto(f"/#/sites/{web_room.site_id}/room?code={target['code']}")
    canvas = drawn(page)
    panel(page).get_by_role("button", name="Look at it").click()
    panel(page).get_by_role("button", name="Clear").click()
    for layer in ("Codes", "Ellipsoids", "Photographs", "Control points", "Poses", "Grid and axes"):
        page.get_by_role("checkbox", name=layer).uncheck()
    expect(canvas).to_have_attribute("data-draw-calls", "1")  # plates alone
    seen = detect(load_photo(canvas.screenshot()).bgr, family_by_name("golay"))
    assert target["code"] in {one.code for one in seen.targets}
    context.close()
    assert not watched.faults


def test_principal_axes_make_up_their_covariance(page: Page) -> None:
    root = np.random.default_rng(2).normal(size=(6, 3, 3)) * [1.0, 0.1, 0.001]
    covariances = root @ root.transpose(0, 2, 1)
    page.goto("/")
    found = page.evaluate(
        """async (all) => {
          const { principalAxes } = await import("/assets/room/covariance.js");
          return all.map(principalAxes);
        }""",
        [*covariances.tolist(), np.diag([4.0, 1.0, 9.0]).tolist()],
    )
    assert found[-1]["sigmas"] == [3.0, 2.0, 1.0]
    for covariance, principal in zip(covariances, found, strict=False):
        axes, sigmas = np.array(principal["axes"]), np.array(principal["sigmas"])
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(axes.T * sigmas**2 @ axes, covariance, rtol=1e-9, atol=1e-12 * sigmas[0] ** 2)


def test_ellipsoids_hold_the_part_that_all_targets_share(page: Page, web_room: Room, web_served: Served) -> None:
    """As ``sigma_m``, which the service computes."""
    published = web_served.client.get(f"/sites/{web_room.site_id}/targets").json()
    page.goto("/")
    found = page.evaluate(
        """async ({ targets, datum }) => {
          const { positionCovariance } = await import("/assets/room/covariance.js");
          return targets.map((target) => positionCovariance(target, datum));
        }""",
        published,
    )
    sigmas_m = [np.sqrt(np.diag(covariance)) for covariance in found]
    np.testing.assert_allclose(sigmas_m, [target["sigma_m"] for target in published["targets"]], rtol=1e-9)


def test_a_code_that_the_map_lacks_is_named(page: Page, web_room: Room) -> None:
    page.goto(f"/#/sites/{web_room.site_id}/room?code=1")
    expect(page.get_by_text("Target 1 is not in version 1")).to_be_visible()


def test_without_webgl_the_tables_tell_the_same(flat_page: Page, web_room: Room, web_served: Served) -> None:
    target = web_served.client.get(f"/sites/{web_room.site_id}/targets").json()["targets"][0]
    flat_page.goto(f"/#/sites/{web_room.site_id}/room")
    expect(flat_page.get_by_text("cannot draw in three dimensions")).to_be_visible()
    expect(flat_page.locator("canvas")).to_have_count(0)
    row = flat_page.get_by_role("row").filter(has_text=str(target["code"])).first
    row.press("Enter")
    expect(panel(flat_page).get_by_role("heading", name=f"Target {target['code']}")).to_be_visible()


def test_a_site_without_a_map_says_what_to_do(page: Page, web_served: Served) -> None:
    page.goto(f"/#/sites/{web_served.new_site(name='Bare')}/room")
    expect(page.get_by_text("No target map yet")).to_be_visible()
