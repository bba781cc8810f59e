"""Single snapshots: the pictures that sites keep of them, and their removal."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, Response

from app.api.dependencies import PathId, Running
from app.api.problems import problems
from app.api.schemas.snapshots import SnapshotsRemoved
from app.api.schemas.texts import Text
from app.api.security import needs
from app.services.capture_time import seconds_of
from app.storage.snapshot_removal import SnapshotFilter

router = APIRouter(tags=["snapshots"])

MEDIA_TYPES = {"JPEG": "image/jpeg", "PNG": "image/png", "WEBP": "image/webp", "HEIC": "image/heic"}
PICTURE = {media_type: {"schema": {"type": "string", "format": "binary"}} for media_type in MEDIA_TYPES.values()}
BEFORE = "Time of capture: ISO 8601 (UTC unless it names a zone) or epoch seconds; snapshots taken earlier are removed."


def snapshots_wanted(
    site_id: PathId,
    device_id: Annotated[Text | None, Query(description="Snapshots of this device alone.")] = None,
    before: Annotated[str | None, Query(max_length=100, description=BEFORE)] = None,
) -> SnapshotFilter:
    """Which snapshots of a site are meant."""
    return SnapshotFilter(site_id, device_id, None if before is None else seconds_of(before, "before"))


@router.get(
    "/poses/{pose_id}/image",
    dependencies=[needs("analyse")],
    response_class=Response,
    responses={200: {"content": PICTURE, "description": "The picture"}, **problems(404, 422, 503)},
)
def get_picture(pose_id: PathId, services: Running) -> Response:
    """The picture of a snapshot, without any position on the Earth; 404 when its site did not keep it."""
    picture = services.keeper.picture(pose_id)
    headers = {"Cache-Control": "private, no-store"}  # it is gone when its time is over
    return Response(picture.data, media_type=MEDIA_TYPES[picture.format], headers=headers)


@router.delete("/poses/{pose_id}", status_code=204, dependencies=[needs("analyse")], responses=problems(404, 422, 503))
def delete_pose(pose_id: PathId, services: Running) -> None:
    """Remove one snapshot, located or refused, with its picture."""
    services.eraser.remove_pose(pose_id)


@router.delete(
    "/trajectories/{trajectory_id}",
    status_code=204,
    dependencies=[needs("analyse")],
    responses=problems(404, 422, 503),
)
def delete_trajectory(trajectory_id: PathId, services: Running) -> None:
    """Remove a trajectory with all its snapshots and their pictures; the device's next snapshot opens another."""
    services.eraser.remove_trajectory(trajectory_id)


@router.delete("/sites/{site_id}/snapshots", dependencies=[needs("analyse")], responses=problems(404, 422, 503))
def delete_snapshots(
    wanted: Annotated[SnapshotFilter, Depends(snapshots_wanted)], services: Running
) -> SnapshotsRemoved:
    """Remove a site's snapshots of one device, before one time, or both, with their pictures."""
    return SnapshotsRemoved(removed=services.eraser.remove_snapshots(wanted))
