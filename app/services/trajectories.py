"""Trajectories as an analyst sees them: opened, found, read page by page."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sqlalchemy.orm import Session

from app.errors import InvalidInput
from app.services.capture_time import seconds_of
from app.storage.imported_trajectories import ImportedTrajectories
from app.storage.paging import BAD_CURSOR, PageRequest, cursor_of
from app.storage.sites import SiteRepository
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import ImportedPart, Place, StoredTrajectory, TimeRange, TrajectoryPart
from app.storage.trajectory_queries import TrajectoryQueries

GREATEST_ORDINAL = 2**31 - 1  # of a database column


@dataclass(frozen=True)
class TrajectoryPage:
    """A trajectory as it stands, some of its poses, and the cursor of the next page or None at the end."""

    trajectory: StoredTrajectory
    part: TrajectoryPart | ImportedPart
    next_cursor: str | None


def open_trajectory(
    session: Session, site_id: str, device_id: str | None, name: str, trajectory_id: str | None = None
) -> StoredTrajectory:
    """A new trajectory of a site; under an id that the client chose, the first one when it asks again.

    Raises
    ------
    NotFound
        When there is no such site.
    Conflict
        When a trajectory of another site has the id.
    """
    site = SiteRepository(session).get(site_id)
    return TrajectoryRepository(session).add(site.site_id, device_id, name, trajectory_id)


def time_range(from_text: str | None, to_text: str | None) -> TimeRange:
    """Times of capture with from <= t < to; each end is epoch seconds or ISO 8601, or open.

    Raises
    ------
    InvalidInput
        When one is no time, or no time lies between them.
    """
    ends = (("from", from_text), ("to", to_text))
    from_s, to_s = (None if text is None else seconds_of(text, field) for field, text in ends)
    return TimeRange(from_s, to_s)


def trajectory_page(session: Session, trajectory_id: str, times: TimeRange, request: PageRequest) -> TrajectoryPage:
    """Snapshots of a time range in the order of time, poses and failures alike; or the poses that came as a file.

    Raises
    ------
    NotFound
    InvalidInput
        For a cursor that no page gave.
    """
    trajectory = TrajectoryRepository(session).get(trajectory_id)
    after = None if request.after is None else _place_of_key(request.after)
    kind = TrajectoryQueries if trajectory.source is None else ImportedTrajectories
    part = kind(session).part(trajectory_id, times, after, request.limit)
    next_cursor = None if part.end is None else cursor_of(_key_of_place(part.end))
    return TrajectoryPage(trajectory, part, next_cursor)


def _key_of_place(place: Place) -> str:
    return f"{place.captured_s!r}/{place.ordinal}"  # repr is exact


def _place_of_key(key: str) -> Place:
    captured, _, ordinal = key.partition("/")
    try:
        place = Place(float(captured), int(ordinal))
    except ValueError as error:
        raise InvalidInput(BAD_CURSOR, field="cursor") from error
    if not math.isfinite(place.captured_s) or not 0 < place.ordinal <= GREATEST_ORDINAL:
        raise InvalidInput(BAD_CURSOR, field="cursor")
    return place
