"""A site's code family through the service: control points, build, map, snapshots."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest

from app.geometry.control import ControlPoint
from app.services.build_options import BuildOptions
from app.services.build_request import request_build
from app.targets.family import FAMILY_NAMES, family_by_name
from tests.api.serving import Served, assert_problem
from tests.family_rooms import U_M, FamilyRoom, family_room

GROSS_SIGMAS = 5.0
COLUMNS = ("name", "code", "dot", "x_m", "y_m", "z_m", "sigma_m", "role")


def csv_of(points: tuple[ControlPoint, ...]) -> str:
    table = io.StringIO()
    rows = csv.writer(table)
    rows.writerow(COLUMNS)
    rows.writerows([p.name, p.code, p.dot, *p.position_m.tolist(), p.sigma_m, p.role] for p in points)
    return table.getvalue()


def survey_of(served: Served, name: str, room: FamilyRoom) -> tuple[str, str]:
    """Site and survey with all photographs."""
    site_id = served.new_site(code_family=name, plate_u_m=U_M)
    assert served.put_control_points(site_id, csv_of(room.plan.control)).status_code == 200
    survey_id = served.new_survey(site_id)
    for file_name, photo in room.photos.items():
        assert served.put_photo(survey_id, file_name, photo.jpeg).status_code == 201
    return site_id, survey_id


@pytest.mark.parametrize("name", ["hamming", "full"])
def test_a_site_of_any_family_is_built_and_located_in(served: Served, name: str) -> None:
    room = family_room(name)
    site_id, survey_id = survey_of(served, name, room)
    job = served.build(survey_id)
    assert job["state"] == "succeeded", job
    published = served.client.get(f"/sites/{site_id}/targets").json()
    codes = {target["code"] for target in published["targets"]}
    assert published["code_family"] == name
    assert room.carried <= codes <= room.codes
    answer = served.locate(site_id, room.snapshot.jpeg).json()
    used = {target["code"] for target in answer["targets"] if target["used"]}
    assert used >= room.snapshot.whole_codes() & codes
    error_m = np.array(answer["position_m"]) - room.site_from_cam.position_m
    assert (np.abs(error_m) < GROSS_SIGMAS * np.array(answer["position_sigma_m"])).all()


def test_the_published_method_builds_a_map_in_the_service(served: Served) -> None:
    room = family_room("full")
    site_id, survey_id = survey_of(served, "full", room)
    options = BuildOptions(strictness="strict", detector="paper")
    with served.services.database.writing() as session:
        job_id = request_build(session, survey_id, options).job_id
    job = served.wait(job_id)
    assert job["state"] == "succeeded", job
    codes = {target["code"] for target in served.client.get(f"/sites/{site_id}/targets").json()["targets"]}
    # Its fixed colour thresholds and its rule of sizes cost it sightings, and a target takes three.
    assert codes <= room.codes
    assert len(codes) >= len(room.carried) / 2


@pytest.mark.parametrize("name", FAMILY_NAMES[:-1])
def test_a_control_point_on_a_code_of_another_family_is_refused(served: Served, name: str) -> None:
    family = family_by_name(name)
    outsider = next(code for code in range(1, 100) if not family.contains(code))
    text = f"{','.join(COLUMNS)}\nP1,{outsider},A,0,0,0,0.001,control\n"
    answer = served.put_control_points(served.new_site(code_family=name), text)
    assert str(outsider) in assert_problem(answer, 422, "invalid-control-points")["detail"]
