"""Plans to photographs: what each section does, and what is said of one that cannot be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.errors import InvalidInput
from app.planning.simulation_plan import Simulation, read_simulation
from app.planning.truth import control_csv, targets_record, walk_truth
from app.services.control_points import check_datum, points_of_records, records_of_csv
from app.targets.family import family_by_name
from app.vision.photo import load_photo

EXAMPLES = sorted((Path(__file__).parents[2] / "examples" / "plans").glob("*.yaml"))

PLAN = """\
seed: 4
room_m: [3, 3, 2.5]
u_mm: 20
post: {count: 12, walls: [south, west], heights_m: [0.8, 1.8]}
camera: {width_px: 320, height_px: 240}
lights:
  ambient: 0.6
  lamps:
    - {at_m: [1.5, 1.5, 2.4], strength: 3, size_m: [0.6, 0.3]}
  windows:
    - {wall: north, at_m: [1.5, 1.3], size_m: [1, 1]}
imaging: {make: Acme, model: Nine, exposure_s: 0.01, jpeg_quality: 80}
path:
  survey:
    - ring: {count: 6, centre_m: [1.9, 1.9], radii_m: [0.8, 0.8]}
    - at_m: [2.4, 2.4, 1.4]
      headings_deg: [200, 225, 250]
    - {at_m: [2.6, 1.8, 1.4], look_at_m: [0, 1, 1.3]}
    - {at_m: [1.8, 2.6, 1.5], look_at_m: [1, 0, 1.3], roll_deg: 90}
  locate:
    - {at_m: [2.5, 2.5, 1.5], look_at_m: [0, 0, 1.3]}
  walk: {waypoints_m: [[2.6, 1.5], [2.6, 2.6], [1.5, 2.6]], every_s: 0.5, look_at_m: [0, 0, 1.3]}
control: {control: 3, check: 1, sigma_mm: 2}
"""


def simulation_of(text: str, folder: Path, seed: int | None = None) -> Simulation:
    path = folder / "plan.yaml"
    path.write_text(text)
    return read_simulation(path, seed)


@pytest.fixture(scope="module")
def simulation(tmp_path_factory: pytest.TempPathFactory) -> Simulation:
    return simulation_of(PLAN, tmp_path_factory.mktemp("plan"))


def test_the_plan_is_all_there(simulation: Simulation) -> None:
    assert [len(simulation.survey), len(simulation.snapshots), len(simulation.scene.targets)] == [11, 6, 12]
    assert simulation.u_m == 0.02 and simulation.seed == 4
    names = [shot.stop.name for shot in simulation.snapshots]
    assert names[:3] == ["IMG_0000.jpg", "WALK_0000.jpg", "WALK_0001.jpg"]
    assert [point.role for point in simulation.control] == ["control"] * 3 + ["check"]


def test_stations_stand_and_look_where_they_are_told(simulation: Simulation) -> None:
    along_225 = simulation.survey[7].stop.site_from_cam
    assert along_225.position_m == pytest.approx([2.4, 2.4, 1.4])
    assert along_225.rotation[:, 2] == pytest.approx([-np.sqrt(0.5), -np.sqrt(0.5), 0.0])
    upright = simulation.survey[10].stop.site_from_cam
    assert upright.rotation[:, 0] @ [0.0, 0.0, -1.0] == pytest.approx(1.0, abs=0.1)  # columns run down the wall
    looked_at = simulation.snapshots[0].stop.site_from_cam.inverse().apply(np.array([0.0, 0.0, 1.3]))
    assert looked_at[:2] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_photograph_tells_its_camera_and_time(simulation: Simulation) -> None:
    second = load_photo(simulation.photograph(simulation.snapshots[2]).jpeg)
    assert (second.header.width_px, second.header.height_px) == (320, 240)
    assert second.header.identity is not None
    assert (second.header.identity.make, second.header.identity.model) == ("Acme", "Nine")
    # The survey's eleven photographs, the snapshot and the walk, each after a pause: 50 + 60 + 60 s, and half a second.
    assert second.header.captured_at == simulation.snapshots[2].imaging.captured_at == "2026:03:02 09:02:50.500"


def test_the_same_seed_gives_the_same_bytes_and_another_does_not(simulation: Simulation, tmp_path: Path) -> None:
    again, other = simulation_of(PLAN, tmp_path), simulation_of(PLAN, tmp_path, seed=5)
    jpeg = simulation.photograph(simulation.survey[0]).jpeg
    assert again.photograph(again.survey[0]).jpeg == jpeg != other.photograph(other.survey[0]).jpeg
    assert control_csv(again.control) == control_csv(simulation.control) != control_csv(other.control)
    assert len({shot.seed for shot in (*simulation.survey, *simulation.snapshots)}) == 17


def test_control_points_err_by_their_sigma_and_are_read_back(simulation: Simulation) -> None:
    records = records_of_csv(control_csv(simulation.control))
    points = points_of_records(records, family_by_name("golay"))
    check_datum(points)
    targets = {target.code: target for target in simulation.scene.targets}
    for point in points:
        assert point.cell is not None and point.sigma_m == 0.002
        error_m = point.position_m - targets[point.code].dots_m()[point.cell]
        assert 0 < np.linalg.norm(error_m) < 5 * 0.002 * np.sqrt(3)


def test_the_truth_of_the_walk_is_that_of_its_photographs(simulation: Simulation) -> None:
    walk = walk_truth(shot.stop for shot in simulation.snapshots)
    assert len(walk) == 5 and np.diff(walk.times_s) == pytest.approx(0.5)
    assert np.array_equal(walk.positions_m[1], simulation.snapshots[2].stop.site_from_cam.position_m)


def test_targets_truth_has_each_target(simulation: Simulation) -> None:
    record = targets_record(simulation.scene.targets, simulation.u_m)
    assert record["u_m"] == 0.02 and np.array(record["targets"][0]["dots_m"]).shape == (16, 3)


def test_listed_points_are_those_asked_for(tmp_path: Path) -> None:
    codes = [target.code for target in simulation_of(PLAN, tmp_path).scene.targets]
    listed = "".join(f"    - {{code: {code}, dot: centre}}\n" for code in codes[:3])
    listed += f"    - {{name: Q, code: {codes[3]}, dot: A, role: check}}\n"
    head = PLAN[: PLAN.index("control:")]
    points = simulation_of(f"{head}control:\n  sigma_mm: 1\n  points:\n{listed}", tmp_path).control
    assert [point.name for point in points] == ["P1", "P2", "P3", "Q"] and points[3].role == "check"


WRONG = [
    ("ambient: 0.6", "ambient: -1", 7, "lights.ambient"),
    ("strength: 3", "watts: 3", 9, "lights.lamps[0].watts"),
    ("wall: north", "wall: attic", 11, "lights.windows[0].wall"),
    ("at_m: [1.5, 1.3], size", "at_m: [2.7, 1.3], size", 11, "lights.windows[0].at_m"),
    ("size_m: [1, 1]", "size_m: [1, 0]", 11, "lights.windows[0].size_m"),
    ("jpeg_quality: 80", "jpeg_quality: 101", 12, "imaging.jpeg_quality"),
    ("make: Acme", "make: Ácme", 12, "imaging.make"),
    ("exposure_s: 0.01", "exposure: 0.01", 12, "imaging.exposure"),
    ("radii_m: [0.8, 0.8]", "radii_m: [0.8, 0]", 15, "path.survey[0].ring.radii_m"),
    ("count: 6, ", "", 15, "path.survey[0].ring"),
    ("headings_deg: [200, 225, 250]", "pitch_deg: 3", 16, "path.survey[1]"),
    ("look_at_m: [0, 1, 1.3]", "look_at_m: [2.6, 1.8, 1.4]", 18, "path.survey[2].look_at_m"),
    ("look_at_m: [0, 1, 1.3]", "look_at_m: [2.6, 1.8, 0]", 18, "path.survey[2].look_at_m"),
    ("every_s: 0.5", "every_s: 0", 22, "path.walk.every_s"),
    ("[2.6, 1.5], [2.6, 2.6]", "[2.6, 2.6], [2.6, 2.6]", 22, "path.walk.waypoints_m"),
    ("every_s: 0.5", "look_aside_deg: 5", 22, "path.walk"),
    ("path:", "path:\n  start: noon", 14, "path.start"),
    ("  survey:", "  surveys:", 14, "path.surveys"),
    ("check: 1,", "check: 400,", 23, "control"),
    ("control: 3", "control: 2", 23, "control.control"),
]


@pytest.mark.parametrize(("right", "wrong", "line", "field"), WRONG)
def test_a_bad_plan_is_told_by_line_and_field(right: str, wrong: str, line: int, field: str, tmp_path: Path) -> None:
    assert right in PLAN
    with pytest.raises(InvalidInput) as caught:
        simulation_of(PLAN.replace(right, wrong, 1), tmp_path)
    assert (caught.value.fields["line"], caught.value.fields["field"]) == (line, field)
    assert caught.value.detail.startswith(f"plan.yaml, line {line}, {field}: ")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("room_m: [3, 3, 2]\npost: {count: 3}\n", "path is missing"),
        ("room_m: [3, 3, 2]\npath: {survey: [{at_m: [1, 1, 1], headings_deg: [0]}]}\n", "there are no targets"),
        (PLAN.replace("camera:", "targets: [{code: 889, wall: east, at_m: [1, 1], u_mm: 9}]\ncamera:"), "one size"),
        (PLAN.replace("wall: north, at_m: [1.5", "wall: south, at_m: [1.5"), "hangs on this window"),
    ],
)
def test_plans_that_cannot_be_photographed_say_why(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match=words):
        simulation_of(text, tmp_path)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_examples_are_plans_that_the_survey_sees_wholly(path: Path) -> None:
    simulation = read_simulation(path)
    assert simulation.survey and simulation.snapshots and len(simulation.control) >= 10
    assert len(simulation.scene.targets) in (20, 60)
