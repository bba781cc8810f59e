"""Trajectories that came as files: written once, read by time."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from app.storage.models import ImportedPosesRow, TrajectoryRow
from app.storage.pose_blobs import pieces_of, pose_columns, poses_of_row
from app.storage.trajectory_parts import FileSource, ImportedPart, Place, StoredTrajectory, TimeRange
from app.storage.trajectory_rows import first_values, stored_trajectory
from app.trajectories.trajectory import Trajectory


@dataclass(frozen=True)
class NewImport:
    """A trajectory that came as a file, on its way into the database.

    Attributes
    ----------
    poses : Trajectory
        One at least, stamps strictly increasing.
    """

    site_id: str
    device_id: str | None
    name: str
    source: FileSource
    poses: Trajectory


class ImportedTrajectories:
    """Trajectories of one session that came as files."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, new: NewImport) -> StoredTrajectory:
        """Keep a trajectory; it is closed from the start."""
        values = first_values(new.site_id, new.device_id, new.name)
        first_s, last_s = float(new.poses.times_s[0]), float(new.poses.times_s[-1])
        values |= {"closed_s": time.time(), "first_s": first_s, "last_s": last_s}
        row = TrajectoryRow(default_key=None, source=asdict(new.source), imported_count=len(new.poses), **values)
        self._session.add(row)
        self._session.flush()
        for first, piece in pieces_of(new.poses):
            place = {"trajectory_id": row.id, "ordinal": first + 1}
            self._session.add(ImportedPosesRow(**place, **bounds_of(piece), **pose_columns(piece)))
            self._session.flush()
            self._session.expunge_all()  # a million poses shall not stay with the session
        return stored_trajectory(row)

    def pieces(self, trajectory_id: str, times: TimeRange, after: Place | None = None) -> Iterator[ImportedPart]:
        """The poses of a time range after a place, piece by piece; pieces without such a pose are left out."""
        conditions = [ImportedPosesRow.trajectory_id == trajectory_id, *overlapping(times)]
        if after is not None:
            conditions.append(ImportedPosesRow.last_s > after.captured_s)
        query = select(ImportedPosesRow).where(*conditions).order_by(ImportedPosesRow.ordinal).limit(1)
        row = self._session.scalars(query).first()
        while row is not None:
            piece = _within(row, times, after)
            self._session.expunge(row)
            if len(piece.poses):
                yield piece
            # Asked anew for each row: whoever needs no more leaves no cursor open.
            row = self._session.scalars(query.where(ImportedPosesRow.ordinal > row.ordinal)).first()

    def part(self, trajectory_id: str, times: TimeRange, after: Place | None, limit: int) -> ImportedPart:
        """The first poses of a time range after a place, and where the next ones begin."""
        taken: list[ImportedPart] = []
        count = 0
        for piece in self.pieces(trajectory_id, times, after):
            taken.append(piece)
            count += len(piece.poses)
            if count > limit:
                break
        return ImportedPart.of_pieces(taken).first(limit)


def overlapping(times: TimeRange) -> list[ColumnElement[bool]]:
    """The condition that a row may hold a pose of a time range."""
    conditions = []
    if times.from_s is not None:
        conditions.append(ImportedPosesRow.last_s >= times.from_s)
    if times.to_s is not None:
        conditions.append(ImportedPosesRow.first_s < times.to_s)
    return conditions


def bounds_of(piece: Trajectory) -> dict[str, Any]:
    """What a row tells of its poses, for whoever looks for some."""
    sigmas = piece.sigmas
    least_m, greatest_m = piece.positions_m.min(axis=0), piece.positions_m.max(axis=0)
    return {
        "first_s": float(piece.times_s[0]),
        "last_s": float(piece.times_s[-1]),
        **{f"least_{axis}_m": float(least_m[row]) for row, axis in enumerate("xyz")},
        **{f"greatest_{axis}_m": float(greatest_m[row]) for row, axis in enumerate("xyz")},
        "least_sigma_m": None if sigmas is None else float(sigmas[:, :3].max(axis=1).min()),
    }


def _within(row: ImportedPosesRow, times: TimeRange, after: Place | None) -> ImportedPart:
    poses = poses_of_row(row)
    wanted = np.ones(len(poses), dtype=np.bool_)
    if times.from_s is not None:
        wanted &= poses.times_s >= times.from_s
    if times.to_s is not None:
        wanted &= poses.times_s < times.to_s
    if after is not None:
        wanted &= poses.times_s > after.captured_s  # stamps are unique, so the time alone is the place
    rows = np.flatnonzero(wanted)
    return ImportedPart(poses.take(rows), row.ordinal + rows, None)
