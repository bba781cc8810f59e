"""Trajectories: opened and closed, found, read, watched."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query
from fastapi.responses import StreamingResponse
from fastapi.sse import EventSourceResponse, ServerSentEvent

from app.api.dependencies import Paging, PathId, ReadSession, Running, WriteSession
from app.api.problems import problems
from app.api.schemas.smoothing import SmoothedAnswer
from app.api.schemas.trajectories import (
    FailureAnswer,
    NewTrajectoryBody,
    SnapshotOfTrajectory,
    TrajectoriesAnswer,
    TrajectoryAnswer,
    TrajectoryPageAnswer,
    pose_answers,
)
from app.api.security import Analysing, Recording, needs
from app.api.smoothing_query import SmoothingWished
from app.api.trajectory_queries import Part, Stream, Wanted
from app.services.trajectories import open_trajectory, trajectory_page
from app.services.trajectory_events import Arrivals, watch_trajectory
from app.services.trajectory_export import TextFormat, trajectory_text
from app.storage.trajectories import TrajectoryRepository
from app.storage.trajectory_queries import TrajectoryQueries

router = APIRouter(tags=["trajectories"])

MEDIA_TYPES: dict[TextFormat, str] = {
    "csv": "text/csv",
    "tum": "text/plain",
    "kitti": "text/plain",
    "kitti-times": "text/plain",
    "euroc": "text/csv",
    "evaal": "text/csv",
    "posi": "text/plain",
    "geojson": "application/geo+json",
    "geopose": "application/json",
}
TEXT_FORMATS = {
    media_type: {"schema": {"type": "string"}}
    for media_type in MEDIA_TYPES.values()
    if media_type != "application/json"  # which has a schema of its own
}
Format = Literal["json", "csv", "tum", "kitti", "kitti-times", "euroc", "evaal", "posi", "geojson", "geopose"]


@router.post("/trajectories", status_code=201, responses=problems(400, 404, 409, 413, 422))
def create_trajectory(body: NewTrajectoryBody, session: WriteSession, principal: Recording) -> TrajectoryAnswer:
    """Open a trajectory; snapshots name it as trajectory_id, which a device without a connection may choose itself."""
    site_id = principal.site(body.site_id)
    return TrajectoryAnswer.of(open_trajectory(session, site_id, body.device_id, body.name or "", body.trajectory_id))


@router.post(
    "/trajectories/{trajectory_id}/close", dependencies=[needs("locate", "analyse")], responses=problems(404, 422)
)
def close_trajectory(trajectory_id: PathId, session: WriteSession) -> TrajectoryAnswer:
    """Take no more snapshots; a closed trajectory stays as it is."""
    return TrajectoryAnswer.of(TrajectoryRepository(session).close(trajectory_id))


@router.get("/trajectories", responses=problems(404, 422))
def list_trajectories(wanted: Wanted, page: Paging, session: ReadSession, principal: Analysing) -> TrajectoriesAnswer:
    """Trajectories in the order they were made.

    With from, to, bbox or max_sigma_m those that hold a snapshot that fits them all; a failure fits a time only. An
    imported trajectory is looked at by some thousand poses at a time, whose bounds must fit.
    """
    return TrajectoriesAnswer.of(TrajectoryQueries(session).page(wanted, page, principal.site_ids))


@router.get(
    "/trajectories/{trajectory_id}",
    dependencies=[needs("analyse")],
    response_model=TrajectoryPageAnswer,
    responses={200: {"content": TEXT_FORMATS}, **problems(404, 409, 422)},
)
def get_trajectory(
    wanted: Part,
    session: ReadSession,
    services: Running,
    format: Annotated[Format, Query()] = "json",  # noqa: A002 - the query's name
) -> Any:
    """A trajectory: poses and failures page by page as json, or the whole range of poses as a file."""
    if format == "json":
        return TrajectoryPageAnswer.of_page(trajectory_page(session, wanted.trajectory_id, wanted.times, wanted.page))
    text = trajectory_text(services.database, wanted.trajectory_id, format, wanted.times)
    return StreamingResponse(text, media_type=MEDIA_TYPES[format])


@router.get(
    "/trajectories/{trajectory_id}/smoothed",
    dependencies=[needs("analyse")],
    response_model=SmoothedAnswer,
    responses={200: {"content": TEXT_FORMATS}, **problems(404, 409, 422, 503, 504)},
)
async def get_smoothed(
    wish: SmoothingWished,
    services: Running,
    format: Annotated[Format, Query()] = "json",  # noqa: A002 - the query's name
) -> Any:
    """The trajectory between its snapshots, with the uncertainty of not having looked; gaps stay gaps."""
    smoothed = await services.smoother.smooth(wish)
    if format == "json":
        return SmoothedAnswer.of(smoothed)
    return StreamingResponse(services.smoother.text(smoothed, format), media_type=MEDIA_TYPES[format])


@router.get(
    "/trajectories/{trajectory_id}/events",
    dependencies=[needs("analyse")],
    response_class=EventSourceResponse,
    responses=problems(404, 422),
)
async def watch_poses(wanted: Stream, services: Running) -> AsyncIterator[ServerSentEvent]:
    """Poses and failures as they come, as events ``pose`` and ``failure``; ``closed`` is the last."""
    async for arrivals in watch_trajectory(services.database, services.bell, wanted.trajectory_id, wanted.after):
        for event in _events(arrivals):
            yield event


def _events(arrivals: Arrivals) -> list[ServerSentEvent]:
    failures = [FailureAnswer.of(failure) for failure in arrivals.part.failures]
    snapshots: list[SnapshotOfTrajectory] = [*pose_answers(arrivals.part), *failures]
    events = [
        ServerSentEvent(data=item, event="failure" if isinstance(item, FailureAnswer) else "pose", id=str(item.ordinal))
        for item in sorted(snapshots, key=lambda snapshot: snapshot.ordinal)
    ]
    if arrivals.ended:
        events.append(ServerSentEvent(data=TrajectoryAnswer.of(arrivals.trajectory), event="closed"))
    return events
