"""What a worker process does for one import: read the file, bring it into the site frame, keep it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from app.services.trajectory_reading import ImportFormat, ReadFile, TrajectoryFile, read_file
from app.services.workbench import workbench
from app.storage.audit import PendingEntry, on_behalf_of
from app.storage.imported_trajectories import ImportedTrajectories, NewImport
from app.storage.sites import SiteRepository
from app.storage.trajectory_parts import FileSource, StoredTrajectory
from app.trajectories.reading.time_units import UnitName


@dataclass(frozen=True)
class ImportWish:
    """What the client says of a file.

    Attributes
    ----------
    name : str
        For people.
    format : str or None
        Seen in the file when None.
    time_unit : {"s", "ms", "us", "ns"} or None
        Seen in the stamps when None.
    """

    site_id: str
    device_id: str | None = None
    name: str = ""
    format: ImportFormat | None = None
    time_unit: UnitName | None = None


@dataclass(frozen=True)
class ImportTask:
    """A file on this machine's disk and what is wanted of it.

    Attributes
    ----------
    times : Path or None
        The stamps' own file.
    audit : PendingEntry or None
        The row that waits for the change.
    """

    wish: ImportWish
    file: Path
    times: Path | None
    audit: PendingEntry | None


def import_trajectory(task: ImportTask) -> StoredTrajectory:
    """The trajectory of a file, kept as a whole or not at all.

    Raises
    ------
    NotFound
        When there is no such site.
    UnreadableTrajectory, InvalidInput, Conflict
        As ``read_file``.
    """
    wish, database = task.wish, workbench().database
    with database.reading() as session:
        anchor = SiteRepository(session).get(wish.site_id).geo_anchor
    times = None if task.times is None else task.times.read_bytes()
    read = read_file(TrajectoryFile(task.file.read_bytes(), times, wish.format, wish.time_unit), anchor)
    new = NewImport(wish.site_id, wish.device_id, wish.name, _source(read), read.reading.trajectory)
    with on_behalf_of(task.audit), database.writing() as session:
        return ImportedTrajectories(session).add(new)


def _source(read: ReadFile) -> FileSource:
    poses, unit = read.reading.trajectory, read.reading.time_unit
    return FileSource(
        format=read.format,
        time_unit=unit.name,
        note=unit.sentence,
        oriented=poses.orientations_xyzw is not None,
        with_covariances=poses.covariances is not None,
        with_floors=poses.floors is not None,
        with_arrivals=poses.arrived_s is not None,
    )
