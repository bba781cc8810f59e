"""Plans: what they hold after reading, in YAML as in JSON, and how faults are named."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from app.errors import InvalidInput
from app.planning.plan_camera import known_from
from app.planning.plan_fields import fields_of_text
from app.planning.plan_file import Plan, plan_of_fields, read_plan
from app.planning.survey_plan import phone_camera

HALL = """
name: Hall
u_mm: 20
walls:
  - name: hall
    outline_m: [[0, 0], [20, 0], [20, 10], [0, 10]]
    height_m: 3
  - {name: pillar, outline_m: [[9, 4], [11, 4], [11, 6], [9, 6]], height_m: 3, faces: outwards}
  - {name: board, corners_m: [[5, 2, 2], [6, 2, 2], [6, 2, 1], [5, 2, 1]]}
  - {name: partition, from_m: [14, 0], to_m: [14, 4], height_m: 2.5}
targets:
  - {code: 389, wall: partition, at_m: [1.0, 1.5]}
  - {code: 400, position_m: [3, 3, 3], normal: [0, 0, -1], u_mm: 14}
post: {count: 12, walls: [hall.1, hall.2, hall.3, hall.4], heights_m: [1, 2]}
camera: {width_px: 1920, height_px: 1080, hfov_deg: 90, dist: [0.1, -0.2, 0, 0]}
view: {height_m: 1.4, min_px_per_u: 3, map: {control_sigma_mm: 0.5}}
path: {anything: 1}
"""


def plan_of(text: str) -> Plan:
    return plan_of_fields(fields_of_text(text.encode(), "plan.yaml"), "plan")


def with_codes() -> str:
    """The hall with codes that its family has."""
    codes = plan_of("{room_m: [5, 5, 3], post: {count: 60}}").targets
    return HALL.replace("389", str(codes[-1].code)).replace("400", str(codes[-2].code))


def test_walls_look_into_the_room_and_out_of_the_pillar() -> None:
    walls = {wall.name: wall for wall in plan_of(with_codes()).walls}
    middle_m = np.array([10.0, 5.0, 1.5])
    for name, wall in walls.items():
        towards = float(wall.site_from_wall.rotation[:, 2] @ (middle_m - wall.site_from_wall.position_m))
        if name.startswith("hall"):
            assert towards > 0
        if name.startswith("pillar"):
            assert towards < 0
    np.testing.assert_allclose(walls["partition"].site_from_wall.rotation[:, 2], [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(walls["partition"].place_m(1.0, 0.5), [14.001, 1, 0.5], atol=1e-12)
    np.testing.assert_allclose(walls["board"].site_from_wall.rotation[:, 2], [0, -1, 0], atol=1e-12)


def test_an_outline_means_the_same_in_either_sense() -> None:
    ring = "[[0, 0], [4, 0], [4, 3], [0, 3]]"
    back = "[[0, 3], [4, 3], [4, 0], [0, 0]]"
    for corners in (ring, back):
        plan = plan_of(f"{{walls: [{{outline_m: {corners}, height_m: 2}}]}}")
        for wall in plan.walls:
            inwards = np.array([2.0, 1.5, 1.0]) - wall.site_from_wall.position_m
            assert wall.site_from_wall.rotation[:, 2] @ inwards > 0


def test_targets_listed_and_posted() -> None:
    plan = plan_of(with_codes())
    assert len(plan.targets) == 14 and len({target.code for target in plan.targets}) == 14
    on_partition, overhead = plan.targets[:2]
    np.testing.assert_allclose(on_partition.site_from_target.position_m, [14.001, 1, 1.5], atol=1e-12)
    assert (on_partition.u_m, overhead.u_m) == (0.02, 0.014)
    np.testing.assert_allclose(overhead.site_from_target.rotation[:, 2], [0, 0, -1], atol=1e-12)
    heights_m = {round(float(target.site_from_target.position_m[2]), 6) for target in plan.targets[2:]}
    assert heights_m == {1.0, 2.0}


def test_camera_and_view() -> None:
    plan = plan_of(with_codes())
    assert plan.camera.camera.fx_px == pytest.approx(960)  # half the width at half of 90 degrees
    assert (plan.view.height_m, plan.view.limits.min_px_per_u, plan.view.survey.control_sigma_m) == (1.4, 3, 0.0005)
    assert list(plan.sections) == ["path"]


def test_json_reads_as_yaml(tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    path.write_text(json.dumps(yaml.safe_load(with_codes()), indent="\t"))
    plan, same = read_plan(path), plan_of(with_codes())
    assert [target.code for target in plan.targets] == [target.code for target in same.targets]
    assert [wall.name for wall in plan.walls] == [wall.name for wall in same.walls]


def test_random_posting_is_repeated_by_its_seed() -> None:
    text = "{room_m: [5, 4, 2.6], post: {count: 20, spread: random, seed: SEED, roll_deg: 10}}"
    once, again, other = (plan_of(text.replace("SEED", seed)).targets for seed in ("3", "3", "4"))
    places = [np.array([target.site_from_target.position_m for target in targets]) for targets in (once, again, other)]
    np.testing.assert_array_equal(places[0], places[1])
    assert not np.allclose(places[0], places[2])
    apart_m = np.linalg.norm(places[0][:, None] - places[0], axis=2) + 9 * np.eye(20)
    assert apart_m.min() > 0.014 * 15


def test_sources_of_intrinsics_are_ordered() -> None:
    camera = phone_camera(1920, 1080)
    sigmas = [np.sqrt(known_from(camera, source).covariance[0, 0]) for source in ("survey", "model", "exif")]
    assert sigmas[0] < sigmas[1] < sigmas[2]


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("    height_m: 3\n", "    heigth_m: 3\n", "line 7, walls[0].heigth_m: there is no such field; is height_m"),
        ("count: 12", "count: many", "line 14, post.count: a number is needed"),
        ("count: 12", "count: 1.5", "line 14, post.count: 1.5 is no whole number"),
        ("hall.4]", "hall.9]", "line 14, post.walls[3]: there is no wall 'hall.9'"),
        ("hfov_deg: 90", "hfov_deg: 190", "line 15, camera.hfov_deg: 190 is not between 1 and 179"),
        ("hfov_deg: 90", "hfov_deg: 90, focal_px: 900", "line 15, camera: say one of focal_px, hfov_deg"),
        ("at_m: [1.0, 1.5]", "at_m: [5.0, 1.5]", "line 12, targets[0].at_m: it lies beside the wall partition"),
        ("[6, 2, 1], [5, 2, 1]", "[7, 2, 1], [5, 2, 1]", "line 9, walls[2].corners_m: the corners are no rectangle"),
        ("to_m: [14, 4]", "to_m: [14, 0]", "line 10, walls[3]: from_m and to_m are the same place"),
        ("name: board", "name: hall.1", "line 9, walls[2]: there is a wall hall.1 already"),
        ("name: Hall\n", "name: Hall\nname: Hall\n", "line 3, name: it is said twice"),
        ("pillar, outline", "pillar outline", "line 8: neither YAML nor JSON"),
    ],
)
def test_faults_are_named_with_line_and_field(old: str, new: str, told: str) -> None:
    text = with_codes()
    assert old in text
    with pytest.raises(InvalidInput) as fault:
        plan_of(text.replace(old, new, 1))
    assert f"plan.yaml, {told}" in fault.value.detail


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="cannot read the plan"):
        read_plan(tmp_path / "none.yaml")
