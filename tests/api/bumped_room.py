"""The demonstration room after somebody bumped into a target: a map that it fits no more, and snapshots of it."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import httpx
import numpy as np

from app.geometry.target_map import TargetMap
from app.storage.ids import new_id
from app.storage.records import Origin, Publication
from app.storage.target_maps import TargetMapRepository
from tests.api.serving import Served
from tests.demo_room import demo_camera, demo_scene, photograph, with_moved

MOVED, SHIFT_M = 72185, np.array([0.012, 0.0, -0.009])
UNKNOWN = 66957  # hangs in the room and is not in the map
# Eye and aim of the snapshots, all before the north wall, where both targets hang.
VIEWS_M = [
    ([0.8, 1.3, 1.4], [1.0, 4.0, 1.6]),
    ([1.6, 1.5, 1.5], [1.0, 4.0, 1.6]),
    ([2.4, 1.9, 1.5], [1.1, 4.0, 1.6]),
    ([1.2, 2.2, 1.6], [1.1, 4.0, 1.6]),
    ([2.0, 1.1, 1.3], [1.2, 4.0, 1.6]),
    ([0.6, 1.9, 1.5], [1.1, 4.0, 1.6]),
]


@dataclass(frozen=True)
class Watched:
    """A site with a map that its room does not fit any more, and its alerts before and after the snapshots."""

    site_id: str
    target_map: TargetMap
    early: list[dict[str, object]]
    answers: list[httpx.Response]


def publish(served: Served, site_id: str, target_map: TargetMap) -> None:
    origin = Origin(served.new_survey(site_id), new_id())
    with served.services.database.writing() as session:
        maps = TargetMapRepository(session)
        maps.activate(site_id, maps.publish(site_id, Publication(target_map, origin, (), (), {})))


def alerts(served: Served, site_id: str, **query: str | int) -> list[dict[str, object]]:
    answer = served.client.get(f"/sites/{site_id}/alerts", params=query)
    assert answer.status_code == 200, answer.text
    found: list[dict[str, object]] = answer.json()["alerts"]
    return found


def bumped_room(served: Served, surveyed_id: str) -> Watched:
    """Another site with the map of a surveyed one, less a target, whose room was changed since; six snapshots of it."""
    site_id = served.new_site(name="the room after somebody bumped into it")
    with served.services.database.reading() as session:
        whole = TargetMapRepository(session).load(surveyed_id, 1)
    target_map = replace(whole, targets=tuple(target for target in whole.targets if target.code != UNKNOWN))
    publish(served, site_id, target_map)
    scene, answers = with_moved(demo_scene(), MOVED, SHIFT_M), []
    early: list[dict[str, object]] = []
    for index, (eye_m, aim_m) in enumerate(VIEWS_M):
        image = photograph(scene, eye_m, aim_m, seed=index)
        sent = {"device_id": "phone", "camera": _camera(), "captured_at": str(1_800_000_000 + index)}
        answers.append(served.locate(site_id, image, **sent))
        if index == 1:
            early = alerts(served, site_id)
    return Watched(site_id, target_map, early, answers)


def _camera() -> str:
    camera = demo_camera()
    fx, fy, cx, cy, *dist = camera.intrinsics.tolist()
    told = {"width_px": camera.width_px, "height_px": camera.height_px, "fx": fx, "fy": fy, "cx": cx, "cy": cy}
    return json.dumps({**told, "dist": dist})
