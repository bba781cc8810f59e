"""Trajectories of known snapshots for tests of what is asked of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.storage.database import Database
from app.storage.snapshots import Heading, Located, Moment, NewSnapshot, NotFoundPose, Seen, SeenTarget
from app.storage.trajectories import TrajectoryRepository
from tests.storage.examples import REFUSED, site_with_survey

START_S = 1.78e9
DEVICE = "walker"


@dataclass(frozen=True)
class Step:
    """A snapshot: when (seconds after the start), where (None: a failure) and how well."""

    after_s: float
    position_m: tuple[float, float, float] | None = None
    sigma_m: float = 0.001
    reason: str = "no-targets"


def new_snapshot(site_id: str, step: Step) -> NewSnapshot:
    captured_s = START_S + step.after_s
    heading = Heading(site_id, 2, Moment(captured_s, "client", 0.01), captured_s + 0.3, DEVICE)
    seen = Seen((SeenTarget(389, 0, 0.06, True),), (), (("total", 20.0),))
    return NewSnapshot(heading, _outcome(step), seen)


def _outcome(step: Step) -> Located | NotFoundPose:
    if step.position_m is None:
        return replace(REFUSED, reason=step.reason)
    pose = Pose(exp_rotation(np.array([0.1, step.after_s % 3.0, 0.2])), np.array(step.position_m))
    covariance = np.diag([0.25, 1.0, 0.25, 1.0, 1.0, 1.0]) * step.sigma_m**2  # the greatest along y
    return Located(pose, covariance, 1.0, 250, 0.06, "survey")


def add_walk(database: Database, site_id: str, steps: Sequence[Step]) -> str:
    """A trajectory of these snapshots, added in their order; its id."""
    with database.writing() as session:
        trajectories = TrajectoryRepository(session)
        trajectory_id = trajectories.add(site_id, DEVICE, "walk").trajectory_id
    add_steps(database, trajectory_id, site_id, steps)
    return trajectory_id


def add_steps(database: Database, trajectory_id: str, site_id: str, steps: Sequence[Step]) -> None:
    with database.recording() as session:
        for step in steps:
            TrajectoryRepository(session).record(trajectory_id, new_snapshot(site_id, step))


def new_site(database: Database) -> str:
    return site_with_survey(database)[0].site_id
