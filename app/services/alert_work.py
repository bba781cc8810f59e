"""What is done to know a map's alerts: evidence -> watch -> troubles -> rows."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from app.photogrammetry.map_watch import Finding, WatchOptions, watch_map
from app.services.workbench import workbench
from app.storage.alerts import AlertFigures, AlertRepository, Severity, Trouble
from app.storage.database import Database
from app.storage.map_evidence import EvidenceRepository
from app.storage.target_maps import TargetMapRepository

# Of a map version. A target of a hundred is in view in one snapshot of five: these hold a hundred sightings of it.
SNAPSHOTS_WATCHED = 500
SNAPSHOTS_KEPT = 1000
# The accuracy that snapshots must have (10 mm): a target that is off by more, alone, spoils a pose by as much.
CRITICAL_M = 0.010


@dataclass(frozen=True)
class WatchTask:
    """A map version that is to be looked at."""

    site_id: str
    map_version: int


def watch_site(task: WatchTask) -> int:
    """Look at a map version by the newest snapshots and keep what is wrong with it; how many troubles there are.

    Raises
    ------
    NotFound
        When there is no such site or version.
    """
    bench = workbench()
    return settle_alerts(bench.database, task, WatchOptions())


def settle_alerts(database: Database, task: WatchTask, options: WatchOptions) -> int:
    """``watch_site`` by a database alone."""
    with database.reading() as session:
        snapshots = EvidenceRepository(session).newest(task.site_id, task.map_version, SNAPSHOTS_WATCHED)
        target_map = TargetMapRepository(session).load(task.site_id, task.map_version)
    troubles = [trouble_of(finding) for finding in watch_map(snapshots, target_map, options)]
    with database.writing() as session:
        AlertRepository(session).settle(task.site_id, task.map_version, troubles, time.time())
    return len(troubles)


def trouble_of(finding: Finding) -> Trouble:
    """A finding as it is kept."""
    moved, spread = finding.displacement_m, finding.covariance_m2
    figures = AlertFigures(
        None if moved is None else (float(moved[0]), float(moved[1]), float(moved[2])),
        None if spread is None else tuple(tuple(line) for line in spread.tolist()),
        finding.excess,
    )
    return Trouble(
        kind=finding.kind,
        code=finding.code,
        severity=severity_of(finding),
        since_s=finding.since_s,
        last_s=finding.last_s,
        snapshots=finding.snapshots,
        places=finding.places,
        devices=finding.devices,
        figures=figures,
    )


def severity_of(finding: Finding) -> Severity:
    """``critical``: poses suffer now; ``warning``: they will; ``notice``: they do not."""
    if finding.kind == "map-misfit":
        return "critical"
    if finding.kind in ("unknown-target", "vanished-target"):
        return "notice"
    far = finding.displacement_m is not None and float(np.linalg.norm(finding.displacement_m)) > CRITICAL_M
    return "critical" if far else "warning"
