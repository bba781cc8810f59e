"""What must be known before a snapshot is worked on, in one statement; it also tells whether held cameras are right."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy import BindParameter, ColumnElement, Connection, Select, bindparam, func, select

from app.storage.models import CameraRow, SiteRow, SnapshotRow, TrajectoryRow
from app.storage.records import Keep
from app.storage.sites import no_site


@dataclass(frozen=True)
class Question:
    """What a request names."""

    site_id: str
    device_id: str | None = None
    snapshot_id: str | None = None
    trajectory_id: str | None = None
    camera_id: str | None = None


@dataclass(frozen=True)
class CameraState:
    """How many cameras there are and when the newest came: cameras come and go and never change.

    The count alone would miss one that came with another's end, the time one that a slow clock made.
    """

    count: int
    newest_s: float | None


@dataclass(frozen=True)
class LocateFacts:
    """What a request meets.

    Attributes
    ----------
    active_version : int or None
        Of the target map.
    keep : Keep
        Which snapshots' pictures the site keeps.
    of_site, of_device : CameraState
        Cameras that the site's surveys and the device brought.
    takes : bool
        Whether the named trajectory takes snapshots of the site; False when none is named.
    answered, camera_there : bool
        Whether the site has a snapshot with this id, and whether the named camera exists.
    """

    active_version: int | None
    keep: Keep
    of_site: CameraState
    of_device: CameraState
    takes: bool
    answered: bool
    camera_there: bool


def _count_and_newest(condition: ColumnElement[bool]) -> tuple[ColumnElement[int], ColumnElement[float | None]]:
    count = select(func.count()).select_from(CameraRow).where(condition)
    newest = select(func.max(CameraRow.created_s)).where(condition)
    return count.scalar_subquery(), newest.scalar_subquery()


def _statement() -> Select[Any]:
    """Every part is a walk along an index to one row, or over the handful of cameras of a site."""
    site_id: BindParameter[str] = bindparam("site_id")
    takes = (
        TrajectoryRow.id == bindparam("trajectory_id"),
        TrajectoryRow.site_id == site_id,
        TrajectoryRow.closed_s.is_(None),
    )
    answered = (SnapshotRow.site_id == site_id, SnapshotRow.snapshot_id == bindparam("snapshot_id"))
    there = CameraRow.id == bindparam("camera_id")
    return select(
        SiteRow.active_version,
        SiteRow.keep_snapshots,
        *_count_and_newest(CameraRow.site_id == site_id),
        *_count_and_newest(CameraRow.device_id == bindparam("device_id")),
        select(func.count()).select_from(TrajectoryRow).where(*takes).scalar_subquery(),
        select(func.count()).select_from(SnapshotRow).where(*answered).scalar_subquery(),
        select(func.count()).select_from(CameraRow).where(there).scalar_subquery(),
    ).where(SiteRow.id == site_id)


STATEMENT = _statement()  # built once: for a snapshot that takes longer than its execution


def locate_facts(connection: Connection, question: Question) -> LocateFacts:
    """What a request meets at this moment.

    Raises
    ------
    NotFound
        When the site does not exist.
    """
    row = connection.execute(STATEMENT, vars(question)).one_or_none()
    if row is None:
        raise no_site(question.site_id)
    version, keep, site_count, site_newest_s, device_count, device_newest_s, takes, answered, there = row
    return LocateFacts(
        active_version=version,
        keep=Keep(keep),
        of_site=CameraState(site_count, site_newest_s),
        of_device=CameraState(device_count, device_newest_s),
        takes=bool(takes),
        answered=bool(answered),
        camera_there=bool(there),
    )
