"""The demonstration room with the map of its truth: snapshots are located in it without a survey's minute of work."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from app.geometry.pose import Pose
from app.geometry.similarity import estimate_similarity
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.storage.database import Database
from app.storage.records import Origin, Publication
from app.storage.target_maps import TargetMapRepository
from app.targets.layout import dots_target_m
from tests.api.serving import ROOM, Served

SIGMA_M = 1e-4  # of plates whose places are true
RAYS = 3


def true_room(served: Served, database: Database) -> str:
    """Make a site with the room's map, active; its id."""
    site_id = served.new_site()
    publish_truth(database, site_id, served.new_survey(site_id))
    return site_id


def publish_truth(database: Database, site_id: str, survey_id: str) -> None:
    """Publish the room's true targets as a version of a site's map, and activate it."""
    publication = Publication(true_map(), Origin(survey_id, survey_id), (), (), {})
    with database.writing() as session:
        maps = TargetMapRepository(session)
        maps.activate(site_id, maps.publish(site_id, publication))


def true_map() -> TargetMap:
    """The targets as they hang."""
    truth = json.loads((ROOM / "targets_truth.json").read_text())
    datum = Datum(np.zeros(3), np.eye(7) * SIGMA_M**2)
    return TargetMap(tuple(_target(plate, truth["u_m"]) for plate in truth["targets"]), datum, "golay", truth["u_m"])


def _target(plate: dict[str, Any], u_m: float) -> MappedTarget:
    dots_m = np.array(plate["dots_m"])
    site_from_target = estimate_similarity(dots_target_m(u_m), dots_m)
    pose = Pose(site_from_target.rotation, site_from_target.translation_m)
    return MappedTarget(int(plate["code"]), pose, dots_m, np.eye(6) * SIGMA_M**2, RAYS, rms_px=0.05)


def true_position_m(name: str) -> np.ndarray:
    """Where a snapshot of the room was taken."""
    shots = json.loads((ROOM / "locate" / "truth.json").read_text())["shots"]
    return np.array(next(shot["position_m"] for shot in shots if shot["file"] == name))
