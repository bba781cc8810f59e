"""The two stories told over HTTP: a room is surveyed, then its snapshots are located."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.cli.progress import Report
from app.cli.room import Room
from app.cli.score import Located
from app.cli.service_client import ServiceClient, ServiceProblem
from app.errors import SurveyFailed
from app.geometry.pose import Pose

POLL_S = 0.2
ENDED = ("succeeded", "failed", "cancelled")


@dataclass(frozen=True)
class Surveyed:
    """What the survey of a room gave.

    Attributes
    ----------
    site_id : str
    targets : int
        Targets of the published map.
    report : dict
        The adjustment report as the service answers it.
    build_s : float
        From the request to the published map.
    """

    site_id: str
    targets: int
    report: dict[str, Any]
    build_s: float


def survey_room(client: ServiceClient, room: Room, code_family: str, report: Report) -> Surveyed:
    """Create a site, send control points and photographs, build the target map.

    Raises
    ------
    ServiceProblem
        What the service refuses.
    SurveyFailed
        When the build ends without a map.
    """
    site = {"name": room.folder.resolve().name, "code_family": code_family, "plate_u_m": room.plate_u_m}
    site_id = client.post("sites", body=site)["site_id"]
    client.put("sites", site_id, "control-points", data=room.control_points.read_bytes(), kind="text/csv")
    survey_id = client.post("sites", site_id, "surveys", body={})["survey_id"]
    for done, photo in enumerate(room.survey, start=1):
        client.put("surveys", survey_id, "images", photo.name, data=photo.read_bytes(), kind="application/octet-stream")
        report("uploading photographs", done, len(room.survey))
    began_s = time.monotonic()
    job = _finished(client, client.post("surveys", survey_id, "build", body={})["job_id"], report)
    build_s = time.monotonic() - began_s
    adjustment = client.get("sites", site_id, "report", format="json")
    return Surveyed(site_id, int(job["result"]["targets"]), adjustment, build_s)


def locate_room(client: ServiceClient, site_id: str, room: Room, report: Report) -> Iterator[Located]:
    """Locate each snapshot; a refusal is an answer, any other problem is raised."""
    for done, photo in enumerate(room.snapshots, start=1):
        yield _located(client, site_id, photo.name, photo.read_bytes())
        report("locating snapshots", done, len(room.snapshots))


def _located(client: ServiceClient, site_id: str, name: str, data: bytes) -> Located:
    try:
        answer = client.send_photo("locate", data=data, site_id=site_id)
    except ServiceProblem as problem:
        if problem.kind != "not-located":
            raise
        return Located(name, reason=str(problem.fields["reason"]))
    pose = Pose.from_quaternion(np.array(answer["orientation_xyzw"]), np.array(answer["position_m"]))
    return Located(name, pose, np.array(answer["position_sigma_m"]))


def _finished(client: ServiceClient, job_id: str, report: Report) -> dict[str, Any]:
    while True:
        job: dict[str, Any] = client.get("jobs", job_id)
        if job["stage"]:
            report(f"building: {job['stage']}", int(job["done"]), int(job["total"]))
        if job["state"] in ENDED:
            break
        time.sleep(POLL_S)
    if job["state"] != "succeeded":
        error = job["error"] or {}
        raise SurveyFailed(f"the build ended as {job['state']}: {error.get('detail', 'no reason given')}")
    return job
