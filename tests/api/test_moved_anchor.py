"""A map is extended over HTTP although a target that would carry its datum was moved meanwhile."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.geometry.pose import Pose
from app.geometry.target_map import TargetMap
from app.storage.ids import new_id
from app.storage.records import Origin, Publication
from app.storage.target_maps import TargetMapRepository
from tests.api.conftest import SurveyedRoom
from tests.api.serving import Served

MOVED_M = 0.03


def with_moved(target_map: TargetMap, code: int) -> TargetMap:
    """The map as it would be had a target hung elsewhere when it was made."""
    target = target_map.by_code[code]
    step_m = MOVED_M * target.site_from_target.rotation[:, 0]
    pose = Pose(target.site_from_target.rotation, target.site_from_target.position_m + step_m)
    elsewhere = replace(target, site_from_target=pose, dots_m=target.dots_m + step_m)
    targets = tuple(elsewhere if one.code == code else one for one in target_map.targets)
    return replace(target_map, targets=targets)


def test_a_moved_anchor_is_let_go_of_named_and_mapped_anew(served: Served, room: SurveyedRoom) -> None:
    with served.services.database.writing() as session:
        maps = TargetMapRepository(session)
        true_map = maps.load(room.site_id, 1)
        places_m = np.array([target.site_from_target.position_m for target in true_map.targets])
        # The farthest from the middle is the first to be an anchor.
        code = true_map.targets[int(np.linalg.norm(places_m - places_m.mean(axis=0), axis=1).argmax())].code
        base = with_moved(true_map, code)
        base_version = maps.publish(room.site_id, Publication(base, Origin(room.survey_id, new_id()), (), (), {}))
    job = served.build(room.survey_id, base_version=base_version, activate=False)
    assert job["state"] == "succeeded", job
    assert served.client.get(job["result"]["report_url"]).json()["extension"]["moved"] == [code]
    version = job["result"]["map_version"]
    published = served.client.get(f"/sites/{room.site_id}/targets", params={"version": version}).json()["targets"]
    found = {target["code"]: np.array(target["position_m"]) for target in published}
    off_m = np.linalg.norm(found[code] - true_map.by_code[code].site_from_target.position_m)
    assert off_m < MOVED_M / 3.0, "it stands where it hangs now"
    for other in base.by_code.keys() - {code}:
        np.testing.assert_array_equal(found[other], base.by_code[other].site_from_target.position_m)
