"""The samples of a live evaluation as a trajectory: for an evaluation with all its options once the walk is over."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.errors import Conflict
from app.storage.database import Session
from app.storage.imported_trajectories import ImportedTrajectories, NewImport
from app.storage.live_evaluations import LiveEvaluationRepository
from app.storage.live_records import Sample
from app.storage.trajectory_parts import FileSource, StoredTrajectory
from app.trajectories.trajectory import Trajectory

LIVE = "live"


def keep_samples(session: Session, live_id: str, name: str | None) -> StoredTrajectory:
    """A closed trajectory of all samples that came until now, of the live evaluation's name unless told.

    Raises
    ------
    NotFound
    Conflict
        When none came.
    """
    live = LiveEvaluationRepository(session).get(live_id)
    samples = LiveEvaluationRepository(session).samples(live_id)
    if not samples:
        raise Conflict(f"no sample came for live evaluation {live_id}; send some first", live_id=live_id)
    poses = _trajectory(samples, live.options.time_offset_s)
    source = FileSource(
        format=LIVE,
        time_unit="s",
        note=f"the samples of live evaluation {live_id}; they count s since 1970",
        oriented=poses.orientations_xyzw is not None,
        with_covariances=False,
        with_floors=poses.floors is not None,
        with_arrivals=poses.arrived_s is not None,
    )
    return ImportedTrajectories(session).add(NewImport(live.site_id, None, name or live.name, source, poses))


def _trajectory(samples: Sequence[Sample], time_offset_s: float) -> Trajectory:
    """What all samples tell; a height that a system does not tell is 0, as in files. Arrivals by the samples' clock."""
    turns = [sample.orientation_xyzw for sample in samples]
    floors = [sample.floor for sample in samples]
    arrived_s = [sample.arrived_s for sample in samples]
    return Trajectory(
        np.array([sample.time_s for sample in samples]),
        np.array([(sample.x_m, sample.y_m, sample.z_m or 0.0) for sample in samples]),
        None if None in turns else np.array(turns, dtype=np.float64),
        floors=None if None in floors else np.array(floors, dtype=np.int64),
        arrived_s=None if None in arrived_s else np.array(arrived_s, dtype=np.float64) - time_offset_s,
    )
