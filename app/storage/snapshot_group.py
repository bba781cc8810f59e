"""Snapshots recorded together: one transaction for many, each with an outcome of its own.

All locks are taken before the first row is written, sites before trajectories and each in the order of their ids: two
servers' groups wait for each other and never in a circle, and a site that is being deleted is noticed before anything
refers to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import Connection, bindparam, insert, or_, select, update
from sqlalchemy.exc import SQLAlchemyError

from app.errors import Conflict, NotFound, OutOfSpace, ScattermarkError, StorageUnavailable
from app.storage.database import Database
from app.storage.ids import new_id
from app.storage.models import EvidenceRow, SiteRow, SnapshotRow, TrajectoryRow
from app.storage.sites import no_site
from app.storage.snapshot_rows import snapshot_of_row, values_of_evidence, values_of_snapshot
from app.storage.snapshots import NewSnapshot, Snapshot
from app.storage.trajectory_parts import StoredTrajectory
from app.storage.trajectory_rows import (
    COUNTED,
    DEFAULT_NAME,
    check_taking,
    counted_values,
    default_key,
    first_values,
    no_trajectory,
    stored_trajectory,
    with_snapshot,
)
from app.storage.upsert import insert_what_is_absent

# Some drivers' own word on a value that JSON does not have goes past the toolkit.
FAULTS_OF_A_ROW = (SQLAlchemyError, ValueError)

# Built once: for a pose row that takes longer than its execution.
SITES = select(SiteRow.id).where(SiteRow.id.in_(bindparam("site_ids", expanding=True))).order_by(SiteRow.id)
SITES = SITES.with_for_update(read=True, key_share=True)  # nobody deletes them meanwhile; others may add as well
TRAJECTORIES = (
    select(TrajectoryRow.__table__)
    .where(
        or_(
            TrajectoryRow.id.in_(bindparam("ids", expanding=True)),
            TrajectoryRow.default_key.in_(bindparam("keys", expanding=True)),
        )
    )
    .order_by(TrajectoryRow.id)
    .with_for_update()
)
COUNT = update(TrajectoryRow).where(TrajectoryRow.id == bindparam("counted_id"))
COUNT = COUNT.values({name: bindparam(name) for name in COUNTED})
EVIDENCE = insert(EvidenceRow)
FIRST = select(SnapshotRow.__table__).where(
    SnapshotRow.site_id == bindparam("site_id"), SnapshotRow.snapshot_id == bindparam("snapshot_id")
)


@dataclass(frozen=True)
class Entry:
    """A snapshot and where it goes: the trajectory that its client named, or None for its device's default."""

    snapshot: NewSnapshot
    trajectory_id: str | None = None

    @property
    def key(self) -> str:
        """Of the default trajectory."""
        return default_key(self.snapshot.heading.site_id, self.snapshot.heading.device_id)


def record_snapshots(database: Database, entries: Sequence[Entry]) -> list[Snapshot | Exception]:
    """Record snapshots in one transaction, each as if it came alone.

    Returns
    -------
    list of Snapshot or Exception
        One per entry, in their order: the snapshot as it stands in its trajectory (the first one, when its
        ``snapshot_id`` was there before), or why it does not: ``NotFound``, ``Conflict``, ``StorageUnavailable``,
        ``OutOfSpace``, or what the database says to a row that it does not take.
    """
    if len(entries) > 1:
        try:
            with database.recording_rows() as connection:
                return list(record_group(connection, entries))
        except (StorageUnavailable, OutOfSpace) as error:
            return [error] * len(entries)  # one by one it would be the same, and take as many times as long
        except (SnapshotIdTaken, Conflict, *FAULTS_OF_A_ROW):
            pass  # nothing is written: one of them stands in the way, and must not be in that of the others
    return [_alone(database, entry) for entry in entries]


def _alone(database: Database, entry: Entry) -> Snapshot | Exception:
    try:
        with database.recording_rows() as connection:
            return record_one(connection, entry)
    except (ScattermarkError, *FAULTS_OF_A_ROW) as error:
        return error


def record_one(connection: Connection, entry: Entry) -> Snapshot:
    """Record a snapshot; one whose ``snapshot_id`` the site already has is not added: the first one is returned.

    Raises
    ------
    NotFound, Conflict
        When site or trajectory do not exist, or the trajectory is closed or belongs to another site.
    """
    try:
        (outcome,) = record_group(connection, [entry])
    except SnapshotIdTaken:
        heading = entry.snapshot.heading
        return snapshot_of_row(connection.execute(FIRST, _name_of(heading.site_id, heading.snapshot_id)).one())
    if isinstance(outcome, ScattermarkError):
        raise outcome
    return outcome


def find_snapshot(connection: Connection, site_id: str, snapshot_id: str) -> Snapshot | None:
    """The snapshot that a client gave this id, None when it has not come yet."""
    row = connection.execute(FIRST, _name_of(site_id, snapshot_id)).one_or_none()
    return None if row is None else snapshot_of_row(row)


def _name_of(site_id: str, snapshot_id: str | None) -> dict[str, str | None]:
    return {"site_id": site_id, "snapshot_id": snapshot_id}


class SnapshotIdTaken(Exception):
    """Another transaction has recorded a snapshot with one of these ids: the ordinals would have a gap."""


def record_group(connection: Connection, entries: Sequence[Entry]) -> list[Snapshot | ScattermarkError]:
    """Record snapshots in a transaction that the caller commits.

    Trajectories' rows stay locked until then, so that ordinals appear in their order.

    Raises
    ------
    SnapshotIdTaken
        When one of them was recorded by somebody else meanwhile; the caller undoes the transaction.
    """
    group = _Group(connection, entries)
    outcomes = [group.place(entry) for entry in entries]
    group.write()
    return outcomes


class _Group:
    """What is locked, what will be written, and who was first with an id."""

    def __init__(self, connection: Connection, entries: Sequence[Entry]) -> None:
        self._connection = connection
        site_ids = {entry.snapshot.heading.site_id for entry in entries}
        self._sites = set(connection.scalars(SITES, {"site_ids": sorted(site_ids)}))
        self._trajectories: dict[str, StoredTrajectory] = {}
        self._defaults: dict[str, str] = {}
        self._lock_trajectories(entries)
        self._first: dict[tuple[str, str], Snapshot] = {}
        self._values: list[dict[str, object]] = []
        self._evidence: list[dict[str, object]] = []
        self._counted: set[str] = set()

    def place(self, entry: Entry) -> Snapshot | ScattermarkError:
        """Give a snapshot its place in its trajectory, or say why it has none."""
        heading = entry.snapshot.heading
        name = None if heading.snapshot_id is None else (heading.site_id, heading.snapshot_id)
        if name is not None and name in self._first:
            return self._first[name]
        try:
            trajectory = self._trajectory_for(entry)
        except (NotFound, Conflict) as error:
            return error
        recorded = self._append(trajectory, entry.snapshot)
        if name is not None:
            self._first[name] = recorded
        return recorded

    def write(self) -> None:
        """Write the rows, in an order that all servers share, and the trajectories' totals."""
        if not self._values:
            return
        rows = sorted(self._values, key=lambda values: (values["site_id"], values["snapshot_id"] or ""))
        if insert_what_is_absent(self._connection, SnapshotRow, rows) < len(rows):
            raise SnapshotIdTaken
        if self._evidence:
            self._connection.execute(EVIDENCE, self._evidence)
        counted = [self._trajectories[trajectory_id] for trajectory_id in sorted(self._counted)]
        totals = [{"counted_id": trajectory.trajectory_id, **counted_values(trajectory)} for trajectory in counted]
        self._connection.execute(COUNT, totals)

    def _lock_trajectories(self, entries: Sequence[Entry]) -> None:
        present = [entry for entry in entries if entry.snapshot.heading.site_id in self._sites]
        ids = sorted({entry.trajectory_id for entry in present if entry.trajectory_id is not None})
        headings = {entry.key: entry.snapshot.heading for entry in present if entry.trajectory_id is None}
        wanted = {"ids": ids, "keys": sorted(headings)}
        self._read_locked(wanted)
        missing = [key for key in wanted["keys"] if key not in self._defaults]
        for key in missing:  # whoever comes first makes it
            values = first_values(headings[key].site_id, headings[key].device_id, DEFAULT_NAME)
            insert_what_is_absent(self._connection, TrajectoryRow, [{**values, "default_key": key}])
        if missing:
            self._read_locked(wanted)

    def _read_locked(self, wanted: dict[str, list[str]]) -> None:
        for row in self._connection.execute(TRAJECTORIES, wanted):
            self._trajectories[row.id] = stored_trajectory(row)
            if row.default_key is not None:
                self._defaults[row.default_key] = row.id

    def _trajectory_for(self, entry: Entry) -> StoredTrajectory:
        site_id = entry.snapshot.heading.site_id
        if site_id not in self._sites:
            raise no_site(site_id)
        trajectory_id = entry.trajectory_id or self._defaults[entry.key]
        if trajectory_id not in self._trajectories:
            raise no_trajectory(trajectory_id)
        check_taking(self._trajectories[trajectory_id], site_id)
        return self._trajectories[trajectory_id]

    def _append(self, trajectory: StoredTrajectory, snapshot: NewSnapshot) -> Snapshot:
        counted = with_snapshot(trajectory, snapshot)
        self._trajectories[trajectory.trajectory_id] = counted
        self._counted.add(trajectory.trajectory_id)
        place = {"id": new_id(), "trajectory_id": trajectory.trajectory_id, "ordinal": counted.snapshot_count}
        self._values.append({**place, **values_of_snapshot(snapshot)})
        if snapshot.tells_of_map:
            self._evidence.append({"pose_id": place["id"], **values_of_evidence(snapshot)})
        return Snapshot(str(place["id"]), trajectory.trajectory_id, snapshot.heading, snapshot.outcome, snapshot.seen)
