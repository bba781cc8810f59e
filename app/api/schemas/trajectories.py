"""Trajectories, their poses and failures."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

from app.api.dependencies import Id
from app.api.schemas.common import Body, Listing, Quaternion, Vector3, time_of
from app.api.schemas.texts import Text
from app.api.schemas.trajectory_import import ImportedPoseAnswer, SourceAnswer, imported_answers
from app.services.trajectories import TrajectoryPage
from app.storage.paging import Page
from app.storage.trajectory_parts import Failure, ImportedPart, Label, StoredTrajectory, TrajectoryPart

# RFC 9562, section 5.7: lists are in the order of ids, and ids of this version in the order of their time.
UUID_7 = "^[0-9a-f]{8}-[0-9a-f]{4}-7[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}$"


class NewTrajectoryBody(Body):
    """A trajectory to be opened."""

    site_id: Id
    trajectory_id: Annotated[
        str | None,
        Field(pattern=UUID_7, description="The client's own, a UUIDv7 in lower case: a repeat gets the first."),
    ] = None
    device_id: Annotated[Text | None, Field(description="The device that it follows, if it is one.")] = None
    name: Annotated[Text | None, Field(description="For people.")] = None


class TrajectoryAnswer(BaseModel):
    """A trajectory and what it holds."""

    trajectory_id: str
    site_id: str
    device_id: str | None
    name: str
    default: bool = Field(description="Whether it collects the device's snapshots that name no trajectory.")
    created_at: str
    closed_at: str | None = Field(description="Null while it takes snapshots.")
    first_at: str | None = Field(description="Earliest time of capture.")
    last_at: str | None = Field(description="Latest time of capture.")
    pose_count: int
    failure_count: int
    failures_by_reason: dict[str, int]
    source: SourceAnswer | None = Field(description="Of one that was imported; null when its poses were located.")

    @classmethod
    def of(cls, trajectory: StoredTrajectory) -> TrajectoryAnswer:
        """The answer for a trajectory."""
        return cls(**fields_of(trajectory))


def fields_of(trajectory: StoredTrajectory) -> dict[str, Any]:
    """What every answer says of a trajectory."""
    times = {"closed_at": trajectory.closed_s, "first_at": trajectory.first_s, "last_at": trajectory.last_s}
    return {
        "trajectory_id": trajectory.trajectory_id,
        "site_id": trajectory.site_id,
        "device_id": trajectory.device_id,
        "name": trajectory.name,
        "default": trajectory.default,
        "created_at": time_of(trajectory.created_s),
        **{name: None if time_s is None else time_of(time_s) for name, time_s in times.items()},
        "pose_count": trajectory.pose_count,
        "failure_count": trajectory.failure_count,
        "failures_by_reason": dict(trajectory.failures),
        "source": None if trajectory.source is None else SourceAnswer.of(trajectory.source),
    }


class TrajectoriesAnswer(Listing):
    """A page of trajectories."""

    trajectories: list[TrajectoryAnswer]

    @classmethod
    def of(cls, page: Page[StoredTrajectory]) -> TrajectoriesAnswer:
        """The answer for a page."""
        return cls(trajectories=[TrajectoryAnswer.of(item) for item in page.items], next_cursor=page.next_cursor)


class SnapshotOfTrajectory(BaseModel):
    """Ground of poses and failures."""

    pose_id: str
    ordinal: int = Field(description="The how-manieth snapshot of its trajectory, by arrival; the id of its event.")
    captured_at: str
    time_source: Literal["client", "server"]
    clock_delay_s: float | None
    map_version: int
    device_id: str | None
    snapshot_id: str | None


class PoseAnswer(SnapshotOfTrajectory):
    """A pose of a trajectory."""

    position_m: Vector3
    orientation_xyzw: Quaternion
    covariance: list[list[float]] = Field(description="6 x 6: position (m, site axes), small rotation (rad, site axes)")
    position_sigma_m: Vector3


class FailureAnswer(SnapshotOfTrajectory):
    """A snapshot without a pose."""

    reason: str
    detail: str
    advice: str

    @classmethod
    def of(cls, failure: Failure) -> FailureAnswer:
        """The answer for a failure."""
        refusal = failure.refusal
        return cls(
            **_fields_of_label(failure.label), reason=refusal.reason, detail=refusal.detail, advice=refusal.advice
        )


class TrajectoryPageAnswer(TrajectoryAnswer, Listing):
    """A trajectory and a page of its snapshots: poses and failures, each in the order of time."""

    poses: list[PoseAnswer] | list[ImportedPoseAnswer]
    failures: list[FailureAnswer]

    @classmethod
    def of_page(cls, page: TrajectoryPage) -> TrajectoryPageAnswer:
        """The answer for a page."""
        part, common = page.part, {**fields_of(page.trajectory), "next_cursor": page.next_cursor}
        if isinstance(part, ImportedPart):
            return cls(poses=imported_answers(part), failures=[], **common)
        failures = [FailureAnswer.of(failure) for failure in part.failures]
        return cls(poses=list(pose_answers(part)), failures=failures, **common)


def pose_answers(part: TrajectoryPart) -> Iterator[PoseAnswer]:
    """The poses of a part."""
    poses = part.poses
    assert poses.orientations_xyzw is not None, "kept poses have an orientation"
    assert poses.covariances is not None and poses.sigmas is not None, "kept poses have a covariance"
    columns = zip(
        part.labels,
        poses.positions_m.tolist(),
        poses.orientations_xyzw.tolist(),
        poses.covariances.tolist(),
        poses.sigmas[:, :3].tolist(),
        strict=True,
    )
    for label, position_m, orientation_xyzw, covariance, sigma_m in columns:
        yield PoseAnswer(
            **_fields_of_label(label),
            position_m=position_m,
            orientation_xyzw=orientation_xyzw,
            covariance=covariance,
            position_sigma_m=sigma_m,
        )


def _fields_of_label(label: Label) -> dict[str, Any]:
    return {
        "pose_id": label.pose_id,
        "ordinal": label.ordinal,
        "captured_at": time_of(label.moment.captured_s),
        "time_source": label.moment.source,
        "clock_delay_s": label.moment.clock_delay_s,
        "map_version": label.map_version,
        "device_id": label.device_id,
        "snapshot_id": label.snapshot_id,
    }
