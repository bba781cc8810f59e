"""What of trajectories is wanted, as the query says it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Header, Query

from app.api.dependencies import Id, Paging, PathId, Running
from app.api.schemas.texts import Text
from app.errors import InvalidInput
from app.services.trajectories import time_range
from app.services.trajectory_events import first_event
from app.storage.paging import PageRequest
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_parts import BAD_BOX, Box, TimeRange, TrajectoryFilter

TIME = "Time of capture: ISO 8601 (UTC unless it names a zone) or epoch seconds; the range takes from <= t < to."
BOX = (
    "A box of the site frame in metres: x_min,y_min,x_max,y_max, or x_min,y_min,z_min,x_max,y_max,z_max. Needs site_id."
)
SIGMA = "Greatest standard deviation of a position along any axis, metres."
LAST = "The id of the last event that came: the stream goes on after it; 0 begins with the first snapshot."


def times_of_query(
    from_: Annotated[str | None, Query(alias="from", max_length=100, description=TIME)] = None,
    to: Annotated[str | None, Query(max_length=100, description=TIME)] = None,
) -> TimeRange:
    """The half-open range of times of capture."""
    return time_range(from_, to)


Times = Annotated[TimeRange, Depends(times_of_query)]


def trajectory_filter(
    times: Times,
    site_id: Id | None = None,
    device_id: Text | None = None,
    bbox: Annotated[str | None, Query(max_length=200, description=BOX, examples=["0,0,5,4"])] = None,
    max_sigma_m: Annotated[float | None, Query(gt=0, allow_inf_nan=False, description=SIGMA)] = None,
) -> TrajectoryFilter:
    """Which trajectories are wanted."""
    return TrajectoryFilter(site_id, device_id, times, None if bbox is None else _box(bbox), max_sigma_m)


Wanted = Annotated[TrajectoryFilter, Depends(trajectory_filter)]


@dataclass(frozen=True)
class PartWanted:
    """Which snapshots of a trajectory are wanted."""

    trajectory_id: str
    times: TimeRange
    page: PageRequest


def part_wanted(trajectory_id: PathId, times: Times, page: Paging) -> PartWanted:
    """Which snapshots of a trajectory are wanted; limit and cursor are for json."""
    return PartWanted(trajectory_id, times, page)


Part = Annotated[PartWanted, Depends(part_wanted)]


@dataclass(frozen=True)
class StreamWanted:
    """A trajectory that exists, and the ordinal after which its events begin."""

    trajectory_id: str
    after: int


def stream_wanted(
    trajectory_id: PathId,
    services: Running,
    last_event_id: Annotated[str | None, Header(description=LAST)] = None,
    last_event: Annotated[str | None, Query(alias="last_event_id", description="As the header.")] = None,
) -> StreamWanted:
    """Where a stream begins, found before it does."""
    with services.database.reading() as session:
        trajectory = TrajectoryRepository(session).get(trajectory_id)
    return StreamWanted(trajectory_id, first_event(trajectory, last_event_id or last_event))


Stream = Annotated[StreamWanted, Depends(stream_wanted)]


def _box(text: str) -> Box:
    try:
        numbers = [float(number) for number in text.split(",")]
    except ValueError as error:
        raise InvalidInput(f"{BAD_BOX}, got {text!r}", field="bbox") from error
    return Box.of_numbers(numbers)
