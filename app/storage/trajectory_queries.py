"""What is asked of trajectories: which there are, and their snapshots by time or by arrival, as arrays."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import Any, TypeAlias, TypeVarTuple, cast

import numpy as np
from sqlalchemy import ColumnElement, Row, Select, case, exists, or_, select, tuple_
from sqlalchemy.orm import Session

from app.geometry.rotation import quaternion_xyzw
from app.storage.belonging import within
from app.storage.blobs import array_of_blob
from app.storage.imported_trajectories import overlapping
from app.storage.models import ImportedPosesRow, SnapshotRow, TrajectoryRow
from app.storage.paging import Page, PageRequest, page_of
from app.storage.snapshots import Moment, NotFoundPose, TimeSource
from app.storage.trajectory_parts import (
    Box,
    Failure,
    Label,
    Place,
    StoredTrajectory,
    TimeRange,
    TrajectoryFilter,
    TrajectoryPart,
)
from app.storage.trajectory_rows import stored_trajectory
from app.trajectories.trajectory import Trajectory

Columns = TypeVarTuple("Columns")
AnyRow: TypeAlias = "Row[*tuple[Any, ...]]"

POSE = (SnapshotRow.x_m, SnapshotRow.y_m, SnapshotRow.z_m, SnapshotRow.rotation, SnapshotRow.covariance)
TIMED_POSE = (SnapshotRow.captured_s, SnapshotRow.ordinal, *POSE)
LABEL = (
    SnapshotRow.id,
    SnapshotRow.ordinal,
    SnapshotRow.captured_s,
    SnapshotRow.time_source,
    SnapshotRow.clock_delay_s,
    SnapshotRow.map_version,
    SnapshotRow.device_id,
    SnapshotRow.snapshot_id,
)
# What a picture showed is long; only a failure's reasons are wanted of it.
TOLD = case((SnapshotRow.reason.is_not(None), SnapshotRow.seen)).label("told")
COLUMNS = (*LABEL, *POSE, SnapshotRow.reason, TOLD)


class TrajectoryQueries:
    """Trajectories of one session, read only."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def page(
        self, wanted: TrajectoryFilter, request: PageRequest, site_ids: Collection[str] | None = None
    ) -> Page[StoredTrajectory]:
        """Trajectories in the order they were made; of these sites alone if given."""
        conditions = (*_conditions(wanted), within(TrajectoryRow.site_id, site_ids))
        query = select(TrajectoryRow).where(*conditions).order_by(TrajectoryRow.id).limit(request.limit + 1)
        if request.after is not None:
            query = query.where(TrajectoryRow.id > request.after)
        return page_of([(row.id, stored_trajectory(row)) for row in self._session.scalars(query)], request.limit)

    def part(self, trajectory_id: str, times: TimeRange, after: Place | None, limit: int) -> TrajectoryPart:
        """Snapshots of a time range in the order of time; those captured at one time in the order of arrival."""
        query = in_time(select(*COLUMNS), trajectory_id, times, after).limit(limit + 1)
        rows = self._session.execute(query).all()
        kept = rows[:limit]
        end = Place(kept[-1].captured_s, kept[-1].ordinal) if len(rows) > limit else None
        return _part(kept, end)

    def poses(
        self, trajectory_id: str, times: TimeRange, after: Place | None, limit: int
    ) -> tuple[Trajectory, Place | None]:
        """The poses of a time range alone, and where the next ones begin or None at the end."""
        query = (
            in_time(select(*TIMED_POSE), trajectory_id, times, after).where(SnapshotRow.reason.is_(None)).limit(limit)
        )
        rows = self._session.execute(query).all()
        return _poses(rows), Place(rows[-1].captured_s, rows[-1].ordinal) if len(rows) == limit else None

    def arrivals(self, trajectory_id: str, after_ordinal: int, limit: int) -> TrajectoryPart:
        """The snapshots that came after one, the first of them; ``end`` is None."""
        query = select(*COLUMNS).where(
            SnapshotRow.trajectory_id == trajectory_id,
            SnapshotRow.ordinal > after_ordinal,
            SnapshotRow.ordinal <= after_ordinal + limit,
        )
        rows = self._session.execute(query).all()
        return _part(sorted(rows, key=lambda row: (row.captured_s, row.ordinal)), None)


def in_time(query: Select[*Columns], trajectory_id: str, times: TimeRange, after: Place | None) -> Select[*Columns]:
    """The query's rows of a trajectory and a time range, in order; the index holds them in this order."""
    captured_s = SnapshotRow.captured_s
    query = query.where(SnapshotRow.trajectory_id == trajectory_id, *_in_range(times))
    if after is not None:
        place = tuple_(captured_s, SnapshotRow.ordinal)
        query = query.where(place > tuple_(after.captured_s, after.ordinal))
    return query.order_by(captured_s, SnapshotRow.ordinal)


def _in_range(times: TimeRange) -> list[ColumnElement[bool]]:
    conditions = []
    if times.from_s is not None:
        conditions.append(SnapshotRow.captured_s >= times.from_s)
    if times.to_s is not None:
        conditions.append(SnapshotRow.captured_s < times.to_s)
    return conditions


def _conditions(wanted: TrajectoryFilter) -> list[ColumnElement[bool]]:
    conditions: list[ColumnElement[bool]] = []
    if wanted.site_id is not None:
        conditions.append(TrajectoryRow.site_id == wanted.site_id)
    if wanted.device_id is not None:
        conditions.append(TrajectoryRow.device_id == wanted.device_id)
    fitting, overlap = _in_range(wanted.times), overlapping(wanted.times)
    if wanted.box is not None:
        fitting += _in_box(wanted.box)
        overlap += _meeting_box(wanted.box)
    if wanted.max_sigma_m is not None:
        fitting.append(SnapshotRow.sigma_m <= wanted.max_sigma_m)
        overlap.append(ImportedPosesRow.least_sigma_m <= wanted.max_sigma_m)
    if fitting:  # a failure's position and sigma are null, which is in no box and below no sigma
        snapshots = exists().where(SnapshotRow.trajectory_id == TrajectoryRow.id, *fitting)
        imported = exists().where(ImportedPosesRow.trajectory_id == TrajectoryRow.id, *overlap)
        conditions.append(or_(snapshots, imported))
    return conditions


def _meeting_box(box: Box) -> list[ColumnElement[bool]]:
    """The condition that some thousand imported poses come near a box: what bounds them meets it."""
    least = (ImportedPosesRow.least_x_m, ImportedPosesRow.least_y_m, ImportedPosesRow.least_z_m)
    greatest = (ImportedPosesRow.greatest_x_m, ImportedPosesRow.greatest_y_m, ImportedPosesRow.greatest_z_m)
    low = [axis >= value for axis, value in zip(greatest, box.least_m, strict=True) if math.isfinite(value)]
    return low + [axis <= value for axis, value in zip(least, box.greatest_m, strict=True) if math.isfinite(value)]


def _in_box(box: Box) -> list[ColumnElement[bool]]:
    axes = (SnapshotRow.x_m, SnapshotRow.y_m, SnapshotRow.z_m)
    least = [axis >= value for axis, value in zip(axes, box.least_m, strict=True) if math.isfinite(value)]
    return least + [axis <= value for axis, value in zip(axes, box.greatest_m, strict=True) if math.isfinite(value)]


def _part(rows: Sequence[AnyRow], end: Place | None) -> TrajectoryPart:
    located = [row for row in rows if row.reason is None]
    failures = tuple(
        Failure(_label(row), NotFoundPose(row.reason, row.told["detail"], row.told["advice"]))
        for row in rows
        if row.reason is not None
    )
    return TrajectoryPart(_poses(located), tuple(_label(row) for row in located), failures, end)


def _poses(rows: Sequence[AnyRow]) -> Trajectory:
    """Columns to arrays, many rows at a time."""
    rotations = array_of_blob(b"".join(row.rotation for row in rows), len(rows), 3, 3)
    return Trajectory(
        times_s=np.array([row.captured_s for row in rows], dtype=np.float64),
        positions_m=np.array([(row.x_m, row.y_m, row.z_m) for row in rows], dtype=np.float64).reshape(-1, 3),
        orientations_xyzw=quaternion_xyzw(rotations) if rows else np.empty((0, 4)),
        covariances=array_of_blob(b"".join(row.covariance for row in rows), len(rows), 6, 6),
    )


def _label(row: AnyRow) -> Label:
    moment = Moment(row.captured_s, cast(TimeSource, row.time_source), row.clock_delay_s)
    return Label(row.id, row.ordinal, moment, row.map_version, row.device_id, row.snapshot_id)
