"""Trajectories of an arriving site that once came as files: their arrays must be poses that a file could have held."""

from __future__ import annotations

import json
from dataclasses import asdict

from pydantic import TypeAdapter
from sqlalchemy import select

from app.storage.database import Session
from app.storage.imported_trajectories import bounds_of
from app.storage.models import ImportedPosesRow, TrajectoryRow
from app.storage.pose_blobs import POSES_A_ROW, poses_of_row
from app.storage.trajectory_parts import FileSource, StoredTrajectory
from app.storage.trajectory_rows import stored_trajectory

SOURCE = TypeAdapter(FileSource)


def check_imported(session: Session) -> None:
    """See that imported trajectories are whole.

    Raises
    ------
    ValueError
        Naming what cannot be right.
    """
    for row in session.scalars(select(TrajectoryRow)):
        trajectory = stored_trajectory(row)
        if trajectory.source is None:
            _require(row.imported_count == 0, "poses without a source")
        else:
            SOURCE.validate_json(json.dumps(asdict(trajectory.source)), strict=True)
            _require(trajectory.closed_s is not None and trajectory.snapshot_count == 0, "an open import")
        _check_poses(session, trajectory)


def _check_poses(session: Session, trajectory: StoredTrajectory) -> None:
    """The rows of a trajectory follow each other without a gap, in time too, and tell what its source says."""
    query = select(ImportedPosesRow).where(ImportedPosesRow.trajectory_id == trajectory.trajectory_id)
    count, last_s = 0, -1.0
    for row in session.scalars(query.order_by(ImportedPosesRow.ordinal)):
        poses = poses_of_row(row)
        _require(0 < len(poses) <= POSES_A_ROW and row.ordinal == count + 1, "the order of poses")
        _require(all(getattr(row, name) == value for name, value in bounds_of(poses).items()), "the bounds of poses")
        _require(bool(last_s < poses.times_s[0]) and bool((poses.times_s[1:] > poses.times_s[:-1]).all()), "a stamp")
        _require(_told(trajectory.source) == _held(row), "what poses tell")
        count, last_s = count + len(poses), float(poses.times_s[-1])
        session.expunge(row)
    _require(count == trajectory.imported_count, "how many poses there are")


def _told(source: FileSource | None) -> tuple[bool, ...] | None:
    if source is None:
        return None
    return source.oriented, source.with_covariances, source.with_floors, source.with_arrivals


def _held(row: ImportedPosesRow) -> tuple[bool, ...]:
    return tuple(held is not None for held in (row.orientations_xyzw, row.covariances, row.floors, row.arrived_s))


def _require(sound: bool, what: str) -> None:
    if not sound:
        raise ValueError(f"{what} cannot be right")
