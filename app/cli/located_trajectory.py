"""Located snapshots as a trajectory file: poses in the order of their EXIF times."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.trajectories.trajectory import Trajectory

EXIF_TIME = re.compile(r"(\d{4}):(\d\d):(\d\d) (\d\d:\d\d:\d\d(?:\.\d+)?)([+-]\d\d:\d\d)?")
SUFFIXES = (".csv", ".tum")

Writer = Callable[[Iterable["Trajectory"]], Iterator[str]]


def check_suffix(path: Path) -> None:
    """Refuse a file of a form that is not written, before anything is located.

    Raises
    ------
    InvalidInput
    """
    if path.suffix.lower() not in SUFFIXES:
        raise InvalidInput(f"{path.name}: a trajectory is written as {' or '.join(SUFFIXES)}; name one of these")


def exif_seconds(name: str, captured_at: str | None) -> float:
    """EXIF's time with its fraction of a second, as if it were UTC when it names no zone; seconds since 1970.

    Raises
    ------
    InvalidInput
        When the photograph tells none.
    """
    told = EXIF_TIME.fullmatch(captured_at or "")
    try:
        if told is None:
            raise ValueError(f"{captured_at!r} is no time of EXIF")
        year, month, day, clock, zone = told.groups()
        return datetime.fromisoformat(f"{year}-{month}-{day}T{clock}{zone or '+00:00'}").timestamp()
    except ValueError as error:
        raise InvalidInput(
            f"{name} does not tell when it was taken (EXIF DateTimeOriginal), so that it has no place in a trajectory; "
            "leave it out, or send photographs as the camera wrote them",
            photo=name,
        ) from error


def write_trajectory(path: Path, records: Sequence[dict[str, Any]]) -> None:
    """Write the records of located snapshots, each with its ``time_s``."""
    from app.trajectories.formats import csv_text
    from app.trajectories.robotics_formats import tum_text

    located = sorted(records, key=lambda record: record["time_s"])
    write: Writer = tum_text if path.suffix.lower() == ".tum" else csv_text
    path.write_text("".join(write([_trajectory(located)] if located else [])))


def _trajectory(located: Sequence[dict[str, Any]]) -> Trajectory:
    import numpy as np

    from app.trajectories.trajectory import Trajectory

    def column(name: str) -> Any:
        return np.array([record[name] for record in located], dtype=np.float64)

    return Trajectory(column("time_s"), column("position_m"), column("orientation_xyzw"), column("covariance"))
