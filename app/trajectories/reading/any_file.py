"""A trajectory from a file whose format is named, or seen in its first line."""

from __future__ import annotations

from typing import Literal

from app.trajectories.reading.csv_file import read_csv
from app.trajectories.reading.euroc import POSE, STATE, read_euroc
from app.trajectories.reading.evaal import LOG_COLUMNS, read_position_log
from app.trajectories.reading.poses import Reading
from app.trajectories.reading.table import UnreadableTrajectory, data_lines, text_of
from app.trajectories.reading.time_units import UnitName
from app.trajectories.reading.tum import COLUMNS, read_tum

FileFormat = Literal["csv", "tum", "euroc", "evaal"]
READERS = {"csv": read_csv, "tum": read_tum, "euroc": read_euroc, "evaal": read_position_log}


def read_trajectory(data: bytes, file_format: FileFormat | None = None, time_unit: UnitName | None = None) -> Reading:
    """A trajectory of any format that stands in one file.

    Parameters
    ----------
    data : bytes
    file_format : {"csv", "tum", "euroc", "evaal"}, optional
        Seen in the first line when not named.
    time_unit : {"s", "ms", "us", "ns"}, optional
        Seen in the stamps when not named.

    Raises
    ------
    UnreadableTrajectory
        Naming line and column; or when the first line is of no known format.
    """
    return READERS[file_format or format_of(data)](data, time_unit)


def format_of(data: bytes) -> FileFormat:
    """The format that the first line of data has.

    Raises
    ------
    UnreadableTrajectory
        When it has none.
    """
    lines = data_lines(text_of(data))
    if not lines:
        raise UnreadableTrajectory("the file holds only comments; send one pose at least")
    number, line = lines[0]
    by_comma, by_blank = line.split(","), line.split()
    if any(character.isalpha() for character in line.replace("e", "").replace("E", "")):
        return "csv"
    if len(by_comma) in (len(POSE), len(STATE)):
        return "euroc"
    if len(by_blank) == len(COLUMNS):
        return "tum"
    if len(LOG_COLUMNS) in (len(by_comma), len(line.split(";")), len(by_blank)):
        return "evaal"
    raise UnreadableTrajectory(
        f"line {number}: this is the first line of no known format (csv with a heading, tum, euroc, evaal); "
        "name the format, or write a heading",
        line=number,
    )
