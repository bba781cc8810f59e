"""In which unit stamps count: seconds since 1970 have ten digits before the point, milliseconds thirteen, and so on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.trajectories.reading.table import Table
from app.trajectories.trajectory import Array

UnitName = Literal["s", "ms", "us", "ns"]
PER_SECOND: dict[UnitName, float] = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
EARLIEST_S, LATEST_S = 1e8, 1e10  # 1973 and 2286: what lies between in one unit does so in no other


@dataclass(frozen=True)
class TimeUnit:
    """The unit of a file's stamps.

    Attributes
    ----------
    name : {"s", "ms", "us", "ns"}
    detected : bool
        The stamps show it, as they count from 1970; else it is the format's own.
    named : bool
        The user or the column's title said it, and was believed.
    """

    name: UnitName
    detected: bool
    named: bool = False

    def to_seconds(self, stamps: Array) -> Array:
        """Stamps in seconds."""
        return stamps / PER_SECOND[self.name]

    @property
    def sentence(self) -> str:
        """For people."""
        if self.named:
            return f"the stamps were read as {self.name}, as was said"
        if self.detected:
            return f"the stamps count {self.name} since 1970"
        return f"the stamps do not count from 1970; they were taken for {self.name}"


def unit_of_stamps(table: Table, column: str, own: UnitName, asked: UnitName | None = None) -> TimeUnit:
    """The unit of a column of stamps.

    Parameters
    ----------
    table : Table
    column : str
    own : {"s", "ms", "us", "ns"}
        What the format says, for clocks that do not count from 1970.
    asked : {"s", "ms", "us", "ns"}, optional
        What the user says, which is believed.

    Raises
    ------
    UnreadableTrajectory
        When the unit changes within the column.
    """
    if asked is not None:
        return TimeUnit(asked, detected=False, named=True)
    stamps = table.column(column)
    units = [_unit_since_1970(float(stamp)) for stamp in (stamps.min(), stamps.max())]
    if units[0] == units[1]:
        return TimeUnit(own, detected=False) if units[0] is None else TimeUnit(units[0], detected=True)
    first = _unit_since_1970(float(stamps[0]))
    row = next(row for row in np.arange(len(stamps)) if _unit_since_1970(float(stamps[row])) != first)
    raise table.refuse(int(row), column, f"{stamps[row]:g} counts in another unit than the first stamp, {stamps[0]:g}")


def _unit_since_1970(stamp: float) -> UnitName | None:
    return next((unit for unit, per in PER_SECOND.items() if EARLIEST_S <= stamp / per < LATEST_S), None)
