"""What the rows of a scratch database say of each other must be so: the one site, its cameras, its trajectories."""

from __future__ import annotations

from collections.abc import Iterator

from sqlalchemy import func, or_, select

from app.storage.archive_format import BadArchive
from app.storage.database import Session
from app.storage.models import CameraRow, SiteRow, SnapshotRow, TrajectoryRow
from app.storage.snapshot_rows import snapshot_of_row
from app.storage.snapshots import Snapshot
from app.storage.trajectory_rows import stored_trajectory

SNAPSHOTS_AT_ONCE = 500


def check_totals(session: Session) -> str:
    """The id of the only site, when nothing belongs to another and its trajectories count what they have.

    Raises
    ------
    BadArchive
    """
    site_ids = session.scalars(select(SiteRow.id)).all()
    if len(site_ids) != 1:
        raise BadArchive(f"a site's archive holds one site, this one holds {len(site_ids)}")
    if session.scalar(select(func.count()).select_from(CameraRow).where(CameraRow.site_id.is_(None))):
        raise BadArchive("the archive holds a camera of no site")
    _check_trajectories(session)
    return site_ids[0]


def snapshots_of(session: Session) -> Iterator[Snapshot]:
    """All snapshots, as they will be read here."""
    for row in session.scalars(select(SnapshotRow).execution_options(yield_per=SNAPSHOTS_AT_ONCE)):
        yield snapshot_of_row(row)
        session.expunge(row)


def _check_trajectories(session: Session) -> None:
    """A snapshot that was removed still counts as one that arrived, so a trajectory may count more than it has."""
    found = (
        select(
            SnapshotRow.trajectory_id,
            func.count().label("count"),
            func.min(SnapshotRow.ordinal).label("first"),
            func.max(SnapshotRow.ordinal).label("last"),
            func.max(SnapshotRow.site_id).label("site_id"),
        )
        .group_by(SnapshotRow.trajectory_id)
        .subquery()
    )
    query = (
        select(TrajectoryRow.id)
        .outerjoin(found, found.columns.trajectory_id == TrajectoryRow.id)
        .where(
            or_(
                func.coalesce(found.columns.count, 0) + TrajectoryRow.removed_count != TrajectoryRow.snapshot_count,
                TrajectoryRow.removed_count < 0,
                found.columns.first < 1,
                found.columns.last > TrajectoryRow.snapshot_count,
            )
        )
    )
    unsound = session.scalars(query).first()
    if unsound is not None:
        raise BadArchive(f"trajectory {unsound} of the archive does not count what it has")
    for row in session.scalars(select(TrajectoryRow)):
        failures = dict(stored_trajectory(row).failures)
        if any(type(count) is not int or count < 0 for count in failures.values()):
            raise BadArchive(f"trajectory {row.id} of the archive counts no failures that can be")
