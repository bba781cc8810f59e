"""The files of ``scattermark evaluate``: trajectories in any format, and what was found out about each."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.storage.records import GeoAnchor
    from app.trajectories.trajectory import Trajectory

# Tests hold these equal to the library's lists, whose import is slow.
FORMATS = ("csv", "tum", "euroc", "kitti", "evaal", "geojson", "geopose")
UNITS = ("s", "ms", "us", "ns")
KITTI = "kitti"
OWN_STAMPS, SHARED_STAMPS = ".times", "times.txt"


@dataclass(frozen=True)
class InputFile:
    """A trajectory from a file.

    Attributes
    ----------
    path : Path
    format, time_unit, note : str
        What the file was, in which unit its stamps count, and how that was known.
    """

    path: Path
    trajectory: Trajectory
    format: str
    time_unit: str
    note: str

    @property
    def sentence(self) -> str:
        """For people."""
        return f"{self.path}: {self.format}, {len(self.trajectory)} poses, {self.note}"


def add_input(parser: argparse.ArgumentParser) -> None:
    """The files and what is said of them."""
    parser.add_argument("reference", type=Path, help="trajectory that is true")
    parser.add_argument("estimate", type=Path, nargs="+", help="trajectories of systems, or of runs of one")
    parser.add_argument(
        "--format",
        choices=FORMATS,
        help="of all files (seen in each file; kitti is never, its stamps stand beside it in NAME.times or times.txt)",
    )
    parser.add_argument("--time-unit", choices=UNITS, help="of all stamps (seen in the stamps)")
    parser.add_argument(
        "--anchor",
        type=float,
        nargs=4,
        metavar=("LAT", "LON", "HEIGHT", "AZIMUTH"),
        help="where the site's origin stands and where its y axis points, for files that tell latitudes",
    )


def read_input(path: Path, arguments: argparse.Namespace) -> InputFile:
    """The trajectory of a file.

    Raises
    ------
    InvalidInput
        Naming the file, the line and the column.
    """
    from app.services.trajectory_reading import TrajectoryFile, read_file

    times = _stamps_beside(path).read_bytes() if arguments.format == KITTI else None
    file = TrajectoryFile(path.read_bytes(), times, arguments.format, arguments.time_unit)
    try:
        read = read_file(file, _anchor(arguments))
    except InvalidInput as error:
        raise type(error)(f"{path}: {error.detail}", **error.fields) from error
    unit = read.reading.time_unit
    return InputFile(path, read.reading.trajectory, read.format, unit.name, unit.sentence)


def _stamps_beside(path: Path) -> Path:
    for candidate in (path.with_suffix(OWN_STAMPS), path.with_name(SHARED_STAMPS)):
        if candidate.is_file():
            return candidate
    raise InvalidInput(
        f"{path}: kitti keeps its stamps in a file of their own, and there is no {path.with_suffix(OWN_STAMPS).name} "
        f"or {SHARED_STAMPS} beside it"
    )


def _anchor(arguments: argparse.Namespace) -> GeoAnchor | None:
    from app.storage.records import GeoAnchor

    if arguments.anchor is None:
        return None
    latitude_deg, longitude_deg, height_m, azimuth_deg = arguments.anchor
    return GeoAnchor(latitude_deg, longitude_deg, height_m, azimuth_deg)
