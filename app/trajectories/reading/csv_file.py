"""CSV with a heading: the one this project writes, and whatever names its columns likewise."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

from app.trajectories.formats import (
    COMPONENTS,
    COVARIANCE_COLUMNS,
    CSV_COLUMNS,
    POSITION_COLUMNS,
    QUATERNION_COLUMNS,
    SIGMA_COLUMNS,
)
from app.trajectories.reading.covariances import check_definite
from app.trajectories.reading.poses import Reading, check_arrivals, times_s_of, unit_quaternions, whole_floors
from app.trajectories.reading.table import Table, UnreadableTrajectory, data_lines, read_table, text_of
from app.trajectories.reading.time_units import PER_SECOND, TimeUnit, UnitName, unit_of_stamps
from app.trajectories.trajectory import Array, Trajectory

STAMPS: dict[str, UnitName] = {f"time_{unit}": unit for unit in PER_SECOND}
ARRIVALS: dict[str, UnitName] = {f"arrived_{unit}": unit for unit in PER_SECOND}
WRITTEN_TIME, FLOOR = "time_utc", "floor"
KNOWN = (*CSV_COLUMNS, *(name for name in STAMPS if name not in CSV_COLUMNS), FLOOR, *ARRIVALS)
COMMA = ","

Lines = list[tuple[int, str]]


def read_csv(data: bytes, time_unit: UnitName | None = None) -> Reading:
    """A trajectory from a CSV file whose first line names the columns.

    ``time_s`` (or ``time_ms``, ``time_us``, ``time_ns``, or ``time_utc`` in ISO 8601), ``x_m``, ``y_m`` and, if known,
    ``z_m`` (else 0), ``qx`` to ``qw``, the sigmas or the covariance, ``floor``, and ``arrived_s`` (``_ms``, ...), when
    the position was there to be used, by the same clock. With ``time_s`` there, ``time_utc`` is for people and not
    read. A column that is empty throughout counts as absent.

    Raises
    ------
    UnreadableTrajectory
        Naming line and column.
    """
    (heading_number, heading), *lines = data_lines(text_of(data)) or [(1, "")]
    columns = tuple(name.strip().strip('"') for name in heading.split(COMMA))
    _check_heading(heading_number, columns)
    empty = _empty_columns(columns, lines)
    stamp = next((name for name in STAMPS if name in columns and name not in empty), None)
    table = read_table(lines, columns, COMMA, empty | {WRITTEN_TIME})
    if stamp is None:
        table, unit = _with_written_times(table, columns, lines)
        times_s, _ = times_s_of(table, WRITTEN_TIME, "s", "s")
    else:
        own = STAMPS[stamp]
        times_s, unit = times_s_of(table, stamp, own, time_unit or (None if own == "s" else own))
    trajectory = _trajectory(table, times_s)
    arrived_s = _arrived_s(table, unit)
    if arrived_s is not None:
        column = next(name for name in ARRIVALS if table.has(name))
        check_arrivals(arrived_s - times_s, lambda row, what: table.refuse(row, column, what))
    return Reading(replace(trajectory, arrived_s=arrived_s), unit)


def _check_heading(line: int, columns: Sequence[str]) -> None:
    unknown = next((name for name in columns if name not in KNOWN), None)
    if unknown is not None:
        near = difflib.get_close_matches(unknown, KNOWN, 1)
        advice = (
            f"did you mean {near[0]}?" if near else f"leave it out, or name it as one of {', '.join(KNOWN[:9])}, ..."
        )
        raise UnreadableTrajectory(
            f"line {line}, column {unknown!r}: no such column; {advice}", line=line, column=unknown
        )
    twice = next((name for name in columns if columns.count(name) > 1), None)
    if twice is not None:
        raise UnreadableTrajectory(f"line {line}, column {twice}: named twice; name it once", line=line, column=twice)
    if not {"x_m", "y_m"} <= set(columns) or not {WRITTEN_TIME, *STAMPS} & set(columns):
        raise UnreadableTrajectory(
            f"line {line}: the heading must name x_m, y_m and a time (time_s or time_utc, say); "
            f"it names {', '.join(columns)[:200]}",
            line=line,
        )


def _empty_columns(columns: Sequence[str], lines: Lines) -> frozenset[str]:
    """Columns without a value in the first line; a value in a later one is then found to have no place."""
    fields = lines[0][1].split(COMMA) if lines else []
    empty = frozenset(name for name, field in zip(columns, fields, strict=False) if not field.strip())
    places = [place for place, name in enumerate(columns) if name in empty]
    for number, line in lines:
        values = line.split(COMMA)
        filled = next((place for place in places if place < len(values) and values[place].strip()), None)
        if filled is not None:
            raise UnreadableTrajectory(
                f"line {number}, column {columns[filled]}: it is empty above; fill a column for every pose or for none",
                line=number,
                column=columns[filled],
            )
    return empty


def _with_written_times(table: Table, columns: Sequence[str], lines: Lines) -> tuple[Table, TimeUnit]:
    """The table with the ISO 8601 column as seconds since 1970."""
    place = columns.index(WRITTEN_TIME)
    times_s = np.array([_written_time_s(number, line.split(COMMA)[place]) for number, line in lines])
    with_times = Table(np.column_stack([table.values, times_s]), table.lines, (*table.columns, WRITTEN_TIME))
    return with_times, TimeUnit("s", detected=True)


def _written_time_s(line: int, field: str) -> float:
    try:
        moment = datetime.fromisoformat(field.strip().strip('"'))
    except ValueError as error:
        raise UnreadableTrajectory(
            f"line {line}, column {WRITTEN_TIME}: {field.strip()[:40]!r} is no ISO 8601 time like 2026-03-01T12:00:00Z",
            line=line,
            column=WRITTEN_TIME,
        ) from error
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def _arrived_s(table: Table, unit: TimeUnit) -> Array | None:
    """Arrivals in seconds, shape (N,); in the unit of the stamps unless the column shows or names another."""
    column = next((name for name in ARRIVALS if table.has(name)), None)
    if column is None:
        return None
    named = None if ARRIVALS[column] == "s" else ARRIVALS[column]
    found = unit_of_stamps(table, column, unit.name, named or (None if unit.detected else unit.name))
    return found.to_seconds(table.column(column))


def _trajectory(table: Table, times_s: Array) -> Trajectory:
    height_m = table.column("z_m") if table.has("z_m") else np.zeros(len(times_s))
    positions_m = np.column_stack([table.block(POSITION_COLUMNS[:2]), height_m])
    turned = table.has(*QUATERNION_COLUMNS)
    orientations_xyzw = unit_quaternions(table, QUATERNION_COLUMNS) if turned else None
    floors = whole_floors(table, FLOOR) if table.has(FLOOR) else None
    return Trajectory(times_s, positions_m, orientations_xyzw, _covariances(table, 6 if turned else 3), floors)


def _covariances(table: Table, freedoms: int) -> Array | None:
    """Covariances as written, or diagonal ones of the sigmas, shape (N, freedoms, freedoms)."""
    rows, columns = np.triu_indices(len(COMPONENTS))
    inside = (rows < freedoms) & (columns < freedoms)
    names = [name for name, wanted in zip(COVARIANCE_COLUMNS, inside, strict=True) if wanted]
    covariances = np.zeros((len(table.lines), freedoms, freedoms))
    if table.has(*names):
        covariances[:, rows[inside], columns[inside]] = table.block(names)
        covariances[:, columns[inside], rows[inside]] = table.block(names)
    elif table.has(*SIGMA_COLUMNS[:freedoms]):
        diagonal = np.arange(freedoms)
        covariances[:, diagonal, diagonal] = table.block(SIGMA_COLUMNS[:freedoms]) ** 2
    else:
        return None
    check_definite(covariances, lambda row, what: table.refuse(row, "cov_x_x", what))
    return covariances
