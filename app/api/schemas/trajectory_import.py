"""Trajectories that come as files."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

from app.api.dependencies import Id
from app.api.schemas.common import Body, Quaternion, Vector3, time_of
from app.api.schemas.texts import Text
from app.services.trajectory_import_work import ImportWish
from app.storage.trajectory_parts import FileSource, ImportedPart, StoredTrajectory

FORMAT = "Seen in the file when it is not named; kitti is known by its second file, times."
UNIT = "Of the stamps; seen in those that count from 1970, else the format's own."


class ImportParameters(Body):
    """What is said of a file."""

    site_id: Annotated[
        Id, Field(min_length=1, description="The site in whose frame the positions are, or whose anchor they need.")
    ]
    name: Annotated[Text | None, Field(description="For people.")] = None
    device_id: Annotated[Text | None, Field(description="The device or system that it came from.")] = None
    format: Annotated[
        Literal["csv", "tum", "euroc", "kitti", "evaal", "geojson", "geopose"] | None, Field(description=FORMAT)
    ] = None
    time_unit: Annotated[Literal["s", "ms", "us", "ns"] | None, Field(description=UNIT)] = None

    def to_domain(self) -> ImportWish:
        """The wish."""
        return ImportWish(self.site_id, self.device_id, self.name or "", self.format, self.time_unit)


class ImportAnswer(BaseModel):
    """A trajectory that was taken in."""

    trajectory_id: str
    poses: int
    format: str
    time_unit: str
    note: str = Field(description="What was found out about the stamps; look whether it is what you meant.")

    @classmethod
    def of(cls, trajectory: StoredTrajectory) -> ImportAnswer:
        """The answer for a trajectory that came as a file."""
        source = trajectory.source
        assert source is not None, "an imported trajectory has a source"
        return cls(
            trajectory_id=trajectory.trajectory_id,
            poses=trajectory.pose_count,
            format=source.format,
            time_unit=source.time_unit,
            note=source.note,
        )


class SourceAnswer(BaseModel):
    """Where an imported trajectory came from."""

    format: str
    time_unit: str
    note: str
    oriented: bool = Field(description="Whether its poses have orientations.")
    with_covariances: bool
    with_floors: bool
    with_arrivals: bool

    @classmethod
    def of(cls, source: FileSource) -> SourceAnswer:
        """The answer for a source."""
        return cls(
            format=source.format,
            time_unit=source.time_unit,
            note=source.note,
            oriented=source.oriented,
            with_covariances=source.with_covariances,
            with_floors=source.with_floors,
            with_arrivals=source.with_arrivals,
        )


class ImportedPoseAnswer(BaseModel):
    """A pose of an imported trajectory."""

    ordinal: int = Field(description="The how-manieth of the file.")
    captured_at: str
    position_m: Vector3
    orientation_xyzw: Quaternion | None
    covariance: list[list[float]] | None = Field(description="6 x 6, or 3 x 3 of a position alone.")
    position_sigma_m: Vector3 | None
    floor: int | None
    arrived_at: str | None = Field(description="When it was there to be used, by the clock of captured_at.")


def imported_answers(part: ImportedPart) -> list[ImportedPoseAnswer]:
    """The poses of a part."""
    poses, count = part.poses, len(part.poses)
    nothing: list[Any] = [None] * count
    columns = zip(
        part.ordinals.tolist(),
        poses.times_s.tolist(),
        poses.positions_m.tolist(),
        nothing if poses.orientations_xyzw is None else poses.orientations_xyzw.tolist(),
        nothing if poses.covariances is None else poses.covariances.tolist(),
        nothing if poses.sigmas is None else poses.sigmas[:, :3].tolist(),
        nothing if poses.floors is None else poses.floors.tolist(),
        nothing if poses.arrived_s is None else poses.arrived_s.tolist(),
        strict=True,
    )
    return [
        ImportedPoseAnswer(
            ordinal=ordinal,
            captured_at=time_of(time_s),
            position_m=position_m,
            orientation_xyzw=orientation_xyzw,
            covariance=covariance,
            position_sigma_m=sigma_m,
            floor=floor,
            arrived_at=None if arrived_s is None else time_of(arrived_s),
        )
        for ordinal, time_s, position_m, orientation_xyzw, covariance, sigma_m, floor, arrived_s in columns
    ]
