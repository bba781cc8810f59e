"""A hall of 374 targets and a trajectory of 10,000 poses: what a page must draw without a draw call for each."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.geometry.camera import CalibratedCamera, Camera, CameraIdentity
from app.geometry.pose import Pose
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.storage.records import NewCamera, Origin, PhotoResult, Publication
from app.storage.target_maps import TargetMapRepository
from app.targets.family import family_by_name
from app.targets.layout import dots_target_m
from app.trajectories.robotics_formats import tum_text
from tests.api.serving import Served
from tests.trajectories.walks import walk

TARGETS, POSES, PHOTOS = 374, 10_000, 120
U_M = 0.014
HALL_M = np.array([24.0, 14.0, 4.0])
UP = np.array([0.0, 0.0, 1.0])
CAMERA = CameraIdentity("Maker", "Model", 4000, 3000)

Array = npt.NDArray[np.float64]


def large_site(served: Served) -> str:
    """A site with that map, published where builds publish theirs, and with that trajectory, imported as a file."""
    site_id = served.new_site(name="Exhibition hall")
    survey_id = served.new_survey(site_id, note="synthetic")
    with served.services.database.writing() as session:
        maps = TargetMapRepository(session)
        maps.activate(site_id, maps.publish(site_id, _publication(survey_id)))
    text = "".join(tum_text([walk(POSES / 10.0)]))
    answer = served.client.post("/trajectories/import", params={"site_id": site_id, "name": "patrol"}, content=text)
    assert answer.status_code == 201, answer.text
    assert answer.json()["poses"] == POSES
    return site_id


def _publication(survey_id: str) -> Publication:
    random = np.random.default_rng(4)
    codes = family_by_name("golay").codes[:TARGETS].tolist()
    targets = tuple(_target(code, random) for code in codes)
    photos = tuple(_photo(f"{number:04}.jpg", random, codes) for number in range(PHOTOS))
    intrinsics = np.array([3000.0, 3000.0, 1999.5, 1499.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    camera = NewCamera(CAMERA, CalibratedCamera(Camera(4000, 3000, intrinsics), np.eye(9) * 1e-4, "survey"))
    datum = Datum(np.zeros(3), np.eye(7) * 1e-9)
    return Publication(TargetMap(targets, datum, "golay", U_M), Origin(survey_id, survey_id), (camera,), photos, {})


def _target(code: int, random: np.random.Generator) -> MappedTarget:
    """A plate on a wall, facing the hall."""
    wall = code % 4
    inward = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])[wall]
    position_m = (random.random(3) - [0.5, 0.5, 0.0]) * HALL_M
    position_m[wall // 2] = -inward[wall // 2] * HALL_M[wall // 2] / 2
    pose = Pose(np.column_stack([np.cross(UP, inward), UP, inward]), position_m)
    root = random.normal(size=(6, 6)) * 3e-4
    return MappedTarget(
        code, pose, pose.apply(dots_target_m(U_M, (1.0, 1.0))), root @ root.T + np.eye(6) * 1e-9, 5, 0.1
    )


def _photo(name: str, random: np.random.Generator, codes: list[int]) -> PhotoResult:
    angle_rad = random.random() * 2.0 * np.pi
    forward = np.array([np.cos(angle_rad), np.sin(angle_rad), 0.0])
    position_m = (random.random(3) - 0.5) * HALL_M * [0.7, 0.7, 0.1] + [0.0, 0.0, 1.6]
    pose = Pose(np.column_stack([np.cross(-UP, forward), -UP, forward]), position_m)
    seen = tuple(sorted(random.choice(codes, size=9, replace=False).tolist()))
    return PhotoResult(name, CAMERA.key, pose, np.eye(6) * 1e-6, 0.08, len(seen), codes=seen)
