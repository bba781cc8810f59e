"""Evaluations in the browser: files come in, are compared, and what is seen is what the service tells."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import FilePayload, Locator, Page, expect

from app.trajectories.formats import csv_text
from app.trajectories.robotics_formats import tum_text
from app.trajectories.trajectory import Trajectory
from tests.api.serving import Served
from tests.storage.walks import START_S, Step, add_steps
from tests.trajectories.walks import noisy, walk
from tests.web.screenshots import keep_screenshot

PAPER = Path(__file__).parents[2] / "examples" / "paper"
OFF_M = 0.3  # of the running system, along x
LATE_S = 0.5  # of a clock


def file(name: str, text: str) -> FilePayload:
    return {"name": name, "mimeType": "text/plain", "buffer": text.encode()}


def take_in(page: Page, *files: FilePayload | Path) -> None:
    page.locator('input[type="file"]').set_input_files(list(files))  # type: ignore[arg-type]


def metric(page: Page, name: str) -> Locator:
    return page.get_by_role("region", name="Metrics").get_by_role("row").filter(has_text=name).get_by_role("cell")


def told_of(page: Page, served: Served) -> dict[str, Any]:
    expect(page).to_have_url(re.compile("/evaluations/[0-9a-f-]+$"))
    told: dict[str, Any] = served.client.get(f"/evaluations/{page.url.rpartition('/')[2]}").json()
    return told


def test_the_papers_tables_come_out_of_its_files(page: Page, web_served: Served, tmp_path: Path) -> None:
    site_id = web_served.new_site(name="The paper's room")
    page.goto(f"/#/sites/{site_id}/evaluations")
    expect(page.get_by_text("A comparison takes two trajectories")).to_be_visible()
    take_in(page, file("broken.csv", "time_s,x_m,y_m\n1,0.5,0.5\n2,half,0.5\n"))
    expect(page.get_by_role("alert")).to_contain_text("line 3")
    expect(page.get_by_role("alert")).to_contain_text("x_m")
    take_in(page, *sorted(PAPER.glob("*.csv")))
    expect(page.get_by_text(re.compile("20 poses, format csv, stamps in s"))).to_have_count(5)
    page.get_by_role("combobox", name="Reference", exact=True).select_option(label="truth (20 poses, csv)")
    expect(page.get_by_role("checkbox", checked=True)).to_have_count(4)
    keep_screenshot(page, "evaluations")
    page.get_by_label("Title").fill("Table 4")
    page.get_by_text("Options", exact=True).click()
    page.get_by_label("Association").select_option("nearest")
    page.get_by_label("Lever arm").fill("1, 2")
    page.get_by_role("button", name="Compare").click()
    expect(page.get_by_role("alert").last).to_contain_text("three numbers")
    page.get_by_label("Lever arm").fill("")
    page.get_by_role("button", name="Compare").click()
    expect(page.get_by_role("heading", name="Table 4")).to_be_visible()
    told = told_of(page, web_served)
    names = [system["name"] for system in told["systems"]]
    expected = [f"{system['metrics']['accuracy']['horizontal_m']['rms']:.4f} m" for system in told["systems"]]
    expect(metric(page, "RMS in the plan")).to_have_text(expected)
    assert expected[names.index("samsung-galaxy-s8-1")] == "0.0847 m"  # the paper's Table 4
    expect(page.get_by_role("region", name="Differences").get_by_role("row")).to_have_count(1 + 6)
    expect(page.get_by_label(re.compile("Plan of 80 errors"))).to_be_visible()
    keep_screenshot(page, "evaluation")
    page.get_by_role("checkbox", name="huawei-p10-1").uncheck()
    expect(page.get_by_label(re.compile("Plan of 60 errors"))).to_be_visible()
    with page.expect_download() as download:
        page.get_by_role("link", name="ZIP").click()
    download.value.save_as(tmp_path / "evaluation.zip")
    assert (tmp_path / "evaluation.zip").read_bytes().startswith(b"PK")


def test_a_system_with_a_clock_of_its_own_is_judged(page: Page, web_served: Served) -> None:
    site_id = web_served.new_site(name="Hall")
    reference = walk(40.0, covariances=np.tile(np.diag([1e-6] * 6), (400, 1, 1)))
    wrong = noisy(walk(40.0, 5.0), 0.1)
    late = Trajectory(wrong.times_s - LATE_S, wrong.positions_m, wrong.orientations_xyzw)
    page.goto(f"/#/sites/{site_id}/evaluations")
    take_in(page, file("truth.csv", "".join(csv_text([reference]))), file("slam.tum", "".join(tum_text([late]))))
    expect(page.get_by_text(re.compile("200 poses, format tum, stamps in s"))).to_be_visible()
    page.get_by_text("Options", exact=True).click()
    page.get_by_label("Clock offset").select_option("estimate")
    page.get_by_role("button", name="Compare").click()
    expect(page.get_by_role("heading", name="slam against truth")).to_be_visible()
    told = told_of(page, web_served)
    metrics = told["metrics"]
    offset = metrics["time_offset"]
    expect(metric(page, "Clock offset")).to_have_text(f"{offset['offset_s']:.4f} s ± {offset['sigma_s']:.4f} s")
    assert abs(offset["offset_s"] - LATE_S) < 5 * offset["sigma_s"]
    rms = metrics["intervals_m"]["rms"]
    expect(metric(page, "RMS in space")).to_have_text(f"{rms['value']:.4f} m ({rms['low']:.4f} to {rms['high']:.4f})")
    expect(page.get_by_text(metrics["verdict"]["sentence"])).to_be_visible()
    page.get_by_role("combobox", name="Error", exact=True).select_option("space")
    expect(page.get_by_label("Error in space over time")).to_be_visible()
    page.reload()  # the address is a permalink
    expect(page.get_by_label("Distribution of errors in space")).to_be_visible()
    page.get_by_label(re.compile("Plan of")).focus()
    page.keyboard.press("Home")
    first_mm = 1000 * np.linalg.norm(told["series"]["error_m"][0])
    expect(page.get_by_text(f"{first_mm:.1f} mm")).to_be_visible()
    page.get_by_role("button", name="Delete").click()
    page.get_by_role("button", name="Delete it").click()
    expect(page.get_by_text("No evaluation yet.")).to_be_visible()


def test_a_running_system_is_compared_as_it_goes(page: Page, web_served: Served) -> None:
    site_id = web_served.new_site(name="Corridor")
    body = {"site_id": site_id, "device_id": "walker"}
    reference_id = web_served.client.post("/trajectories", json=body).json()["trajectory_id"]
    page.goto(f"/#/sites/{site_id}/evaluations")
    page.get_by_text("Open a live evaluation").click()
    page.get_by_label("System", exact=True).fill("uwb")
    page.get_by_role("button", name="Open it").click()
    expect(page.get_by_text("No pair yet.")).to_be_visible()
    live_id = page.url.rpartition("/")[2]
    steps = [Step(second, (second, 2.0, 1.5)) for second in (0.0, 1.0, 2.0)]
    add_steps(web_served.services.database, reference_id, site_id, steps)
    samples = [{"time_s": START_S + at_s, "x_m": at_s + OFF_M, "y_m": 2.0, "z_m": 1.5} for at_s in (0.5, 1.5, 2.5)]
    answer = web_served.client.post(f"/evaluations/live/{live_id}/samples", json={"samples": samples})
    assert answer.status_code == 200, answer.text
    expect(page.locator(".figure").filter(has_text="RMSE so far")).to_contain_text("0.3000 m")
    expect(page.locator(".figure").filter(has_text="matched of 3 samples")).to_contain_text("2")
    expect(page.get_by_label("Errors of 2 pairs over time")).to_be_visible()
    page.get_by_role("button", name="Close it").click()
    expect(page.get_by_text("closed", exact=True)).to_be_visible()
    page.get_by_role("link", name="Evaluations").click()
    expect(page.get_by_role("row").filter(has_text="uwb")).to_contain_text("closed")
