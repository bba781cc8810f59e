"""Trajectories as they are kept and asked for, and the parts of them that queries give."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.storage.pose_blobs import joined
from app.storage.snapshots import Moment, NotFoundPose
from app.trajectories.trajectory import Trajectory

BAD_BOX = "bbox takes x_min,y_min,x_max,y_max or x_min,y_min,z_min,x_max,y_max,z_max in metres of the site frame"


@dataclass(frozen=True)
class FileSource:
    """Where an imported trajectory came from.

    Attributes
    ----------
    format, time_unit : str
        Of the file.
    note : str
        What was found out about its stamps, for people.
    oriented, with_covariances, with_floors, with_arrivals : bool
        What it tells beside positions.
    """

    format: str
    time_unit: str
    note: str
    oriented: bool
    with_covariances: bool
    with_floors: bool
    with_arrivals: bool = False


@dataclass(frozen=True)
class StoredTrajectory:
    """Snapshots of one device on one site; a default one collects what names no other. Or poses that came as a file.

    Attributes
    ----------
    snapshot_count : int
        Poses and failures that came; also the ordinal of the latest.
    removed_count : int
        Those among them that were removed.
    failures : tuple of (str, int)
        How many by reason.
    first_s, last_s : float or None
        Earliest and latest time of capture, UTC; None while it is empty.
    source : FileSource or None
        None for one whose poses are located snapshots.
    imported_count : int
        Poses that came as a file.
    """

    trajectory_id: str
    site_id: str
    device_id: str | None
    name: str
    default: bool
    created_s: float
    closed_s: float | None
    snapshot_count: int
    removed_count: int
    failures: tuple[tuple[str, int], ...]
    first_s: float | None
    last_s: float | None
    source: FileSource | None = None
    imported_count: int = 0

    @property
    def oriented(self) -> bool:
        """Whether its poses have orientations."""
        return self.source is None or self.source.oriented

    @property
    def failure_count(self) -> int:
        """Snapshots without a pose."""
        return sum(count for _, count in self.failures)

    @property
    def pose_count(self) -> int:
        """Snapshots with a pose, or poses that came as a file."""
        return self.snapshot_count - self.removed_count - self.failure_count + self.imported_count


@dataclass(frozen=True)
class TimeRange:
    """Times of capture with from_s <= t < to_s, UTC seconds since 1970; None leaves an end open."""

    from_s: float | None = None
    to_s: float | None = None

    def __post_init__(self) -> None:
        if self.from_s is not None and self.to_s is not None and self.from_s >= self.to_s:
            raise InvalidInput("from must lie before to: the range takes from <= t < to", field="from")


@dataclass(frozen=True)
class Box:
    """An upright box of the site frame, its faces included, metres."""

    least_m: tuple[float, float, float]
    greatest_m: tuple[float, float, float]

    def __post_init__(self) -> None:
        pairs = list(zip(self.least_m, self.greatest_m, strict=True))
        if any(math.isnan(value) for pair in pairs for value in pair) or any(least > most for least, most in pairs):
            raise InvalidInput(f"{BAD_BOX}, the least first", field="bbox")

    @classmethod
    def of_numbers(cls, numbers: list[float]) -> Box:
        """The box of four numbers, of any height, or of six.

        Raises
        ------
        InvalidInput
        """
        if len(numbers) == 4:
            x_min, y_min, x_max, y_max = numbers
            return cls((x_min, y_min, -math.inf), (x_max, y_max, math.inf))
        if len(numbers) != 6:
            raise InvalidInput(f"{BAD_BOX}, got {len(numbers)} numbers", field="bbox")
        return cls((numbers[0], numbers[1], numbers[2]), (numbers[3], numbers[4], numbers[5]))


@dataclass(frozen=True)
class TrajectoryFilter:
    """Which trajectories are wanted.

    Time, box and sigma ask for trajectories with a snapshot that fits all three; a failure fits a time only.

    Attributes
    ----------
    max_sigma_m : float or None
        Greatest standard deviation of a position along any axis, metres.
    """

    site_id: str | None = None
    device_id: str | None = None
    times: TimeRange = TimeRange()
    box: Box | None = None
    max_sigma_m: float | None = None

    def __post_init__(self) -> None:
        if self.box is not None and self.site_id is None:
            raise InvalidInput("bbox is meant in the frame of one site: name its site_id", field="bbox")


@dataclass(frozen=True)
class Label:
    """Which snapshot, the how-manieth of its trajectory, and where it came from."""

    pose_id: str
    ordinal: int
    moment: Moment
    map_version: int
    device_id: str | None
    snapshot_id: str | None


@dataclass(frozen=True)
class Failure:
    """A snapshot without a pose."""

    label: Label
    refusal: NotFoundPose


@dataclass(frozen=True)
class Place:
    """Between two snapshots of a trajectory in the order of time: after the one captured then and numbered so."""

    captured_s: float
    ordinal: int


@dataclass(frozen=True)
class TrajectoryPart:
    """Consecutive snapshots of a trajectory.

    Attributes
    ----------
    poses : Trajectory
    labels : tuple of Label
        One per pose.
    failures : tuple of Failure
    end : Place or None
        Where the next part begins; None when there is none.
    """

    poses: Trajectory
    labels: tuple[Label, ...]
    failures: tuple[Failure, ...]
    end: Place | None


@dataclass(frozen=True)
class ImportedPart:
    """Consecutive poses of a trajectory that came as a file.

    Attributes
    ----------
    poses : Trajectory
    ordinals : ndarray of int, shape (N,)
        The how-manieth pose of the file each is, from 1.
    end : Place or None
        Where the next part begins; None when there is none.
    """

    poses: Trajectory
    ordinals: npt.NDArray[np.int64]
    end: Place | None

    @classmethod
    def of_pieces(cls, pieces: Sequence[ImportedPart]) -> ImportedPart:
        """Consecutive pieces as one."""
        if not pieces:
            return cls(Trajectory.empty(), np.zeros(0, dtype=np.int64), None)
        ordinals = np.concatenate([piece.ordinals for piece in pieces])
        return cls(joined([piece.poses for piece in pieces]), ordinals, None)

    def first(self, limit: int) -> ImportedPart:
        """The first poses, and where the others begin."""
        if len(self.poses) <= limit:
            return self
        kept = np.arange(limit)
        end = Place(float(self.poses.times_s[limit - 1]), int(self.ordinals[limit - 1]))
        return ImportedPart(self.poses.take(kept), self.ordinals[kept], end)
