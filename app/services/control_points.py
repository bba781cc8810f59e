"""Control and check points: read row by row with an error per row, checked as a whole, put in place together."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from sqlalchemy.orm import Session

from app.errors import InvalidControlPoints
from app.geometry.control import ControlPoint
from app.storage.sites import SiteRepository
from app.targets.family import CodeFamily, family_by_name

Records = list[dict[str, Any]]  # rows by column name, values as text or numbers

COLUMNS = ("name", "code", "dot", "x_m", "y_m", "z_m", "sigma_m", "role")
NUMBERS = ("x_m", "y_m", "z_m", "sigma_m")
ROWS_SHOWN = 5  # of the row errors in the text; all are in the fields


@dataclass(frozen=True)
class ControlLimits:
    """What can be believed of control points.

    Attributes
    ----------
    least_points : int
        Seven parameters of the datum need three points of three coordinates.
    least_breadth : float
        Second over first singular value of the centred points below which they count as in one line: the rotation
        about that line is then a thousand times weaker than about the others.
    greatest_m : float
        Coordinates beyond it are no room's; those of a national grid lose the millimetres in float arithmetic.
    greatest_name : int
        Characters of a name.
    greatest_points : int
        A tachymeter measures a few hundred a day.
    """

    least_points: int = 3
    least_breadth: float = 1e-3
    greatest_m: float = 1e5
    greatest_name: int = 100
    greatest_points: int = 10_000


@dataclass(frozen=True)
class RowError:
    """What is wrong with one row; rows count from 1, the header of a CSV not counted."""

    row: int
    column: str | None
    problem: str

    def __str__(self) -> str:
        place = f"row {self.row}" if self.column is None else f"row {self.row}, {self.column}"
        return f"{place}: {self.problem}"


def put_control_points(session: Session, site_id: str, records: Records) -> tuple[ControlPoint, ...]:
    """Replace a site's control and check points.

    Parameters
    ----------
    records : sequence of dict
        Rows by column name, values as text or numbers; an empty sequence removes all points.

    Raises
    ------
    NotFound
        When there is no such site.
    InvalidControlPoints
        With ``fields['rows']`` naming each bad row, or when the points cannot carry a datum.
    """
    sites = SiteRepository(session)
    family = family_by_name(sites.get(site_id).code_family)
    points = points_of_records(records, family)
    check_datum(points)
    sites.replace_control_points(site_id, points)
    return points


def records_of_csv(text: str) -> Records:
    """Rows of a CSV file by column name.

    Raises
    ------
    InvalidControlPoints
        When the header lacks a column or a row has more cells than the header.
    """
    reader = csv.DictReader(io.StringIO(text.removeprefix("\ufeff"), newline=""), skipinitialspace=True)
    header = [name.strip() for name in reader.fieldnames or ()]
    missing = [name for name in COLUMNS if name not in header]
    if missing:
        raise InvalidControlPoints(
            f"the first line of the CSV must name the columns {','.join(COLUMNS)}, separated by commas; "
            f"missing are {', '.join(missing)}",
            missing=missing,
        )
    reader.fieldnames = header
    try:
        return list(islice(reader, ControlLimits.greatest_points + 1))  # one more tells that there are too many
    except csv.Error as error:
        raise InvalidControlPoints(f"line {reader.line_num} of the CSV cannot be read: {error}") from error


def points_of_records(
    records: Records, family: CodeFamily, limits: ControlLimits = ControlLimits()
) -> tuple[ControlPoint, ...]:
    """Control points of rows.

    Raises
    ------
    InvalidControlPoints
        Naming each bad row: a cell that is no number, an unknown dot, role or code, a name or dot given twice. Or when
        there are more rows than any site has.
    """
    if len(records) > limits.greatest_points:
        raise InvalidControlPoints(
            f"there are more than {limits.greatest_points} rows: send the points that the survey sees",
            greatest_points=limits.greatest_points,
        )
    points: list[ControlPoint] = []
    errors: list[RowError] = []
    known = _Known()
    for row, record in enumerate(records, start=1):
        read = _point_of_record(row, record, family, limits)
        if isinstance(read, RowError):
            errors.append(read)
        else:
            points.append(read)
            errors.extend(known.repeated(row, read))
    if errors:
        shown = "; ".join(str(error) for error in errors[:ROWS_SHOWN])
        more = f"; and {len(errors) - ROWS_SHOWN} more" if len(errors) > ROWS_SHOWN else ""
        rows = [{"row": error.row, "column": error.column, "problem": error.problem} for error in errors]
        raise InvalidControlPoints(
            f"nothing was stored; correct these rows and send all again: {shown}{more}", rows=rows
        )
    return tuple(points)


def check_datum(points: Sequence[ControlPoint], limits: ControlLimits = ControlLimits()) -> None:
    """Whether the control points among these can carry a datum; none at all is fine, the map is then free.

    Raises
    ------
    InvalidControlPoints
        One or two control points, or all of them in one line.
    """
    positions_m = np.array([point.position_m for point in points if point.role == "control"])
    if not len(points):
        return
    if len(positions_m) < limits.least_points:
        raise InvalidControlPoints(
            f"{len(positions_m)} control points do not fix the frame: give at least {limits.least_points} that are "
            "not in one line (role control; check points do not count), or none at all for a free map",
            control_points=len(positions_m),
        )
    spread = np.linalg.svd(positions_m - positions_m.mean(axis=0), compute_uv=False)
    if spread[1] <= limits.least_breadth * spread[0]:
        raise InvalidControlPoints(
            "the control points are in one line and leave the rotation about it open: add one well off that line",
            control_points=len(positions_m),
        )


def _point_of_record(
    row: int, record: dict[str, Any], family: CodeFamily, limits: ControlLimits
) -> ControlPoint | RowError:
    if set(record) - set(COLUMNS) or any(record.get(name) in (None, "") for name in COLUMNS):
        return _odd_columns(row, record)
    numbers: dict[str, float] = {}
    for column in NUMBERS:
        value = _number(record[column])
        if value is None:
            return RowError(row, column, f"{record[column]!r} is no number of metres (write 4.46)")
        if abs(value) > limits.greatest_m:
            return RowError(row, column, f"{value:g} m is far from any building's own frame: subtract a local origin")
        numbers[column] = value
    code = _number(record["code"])
    if code is None or code != int(code) or not family.contains(int(code)):
        return RowError(row, "code", f"{record['code']!r} is no code of the site's family {family.name}")
    name, dot, role = (str(record[column]).strip() for column in ("name", "dot", "role"))
    if not 0 < len(name) <= limits.greatest_name or not name.isprintable():
        return RowError(row, "name", f"a name has at least one and at most {limits.greatest_name} printable characters")
    position_m = np.array([numbers["x_m"], numbers["y_m"], numbers["z_m"]])
    try:
        return ControlPoint(name, int(code), dot, position_m, numbers["sigma_m"], role)  # type: ignore[arg-type]
    except ValueError as error:  # the domain type says what it does not take
        return RowError(row, None, str(error))


def _odd_columns(row: int, record: dict[str, Any]) -> RowError:
    odd = [str(name) for name in record if name not in COLUMNS]
    if odd:
        named = ", ".join(odd) if None not in record else "more cells than the header"
        return RowError(row, None, f"not expected: {named}; the columns are {', '.join(COLUMNS)}")
    empty = next(name for name in COLUMNS if record.get(name) in (None, ""))
    return RowError(row, empty, "is missing")


def _number(value: Any) -> float | None:
    """A finite number, None for anything else; a decimal comma is not guessed at."""
    if isinstance(value, bool):
        return None
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        return None
    return number if np.isfinite(number) else None


class _Known:
    """Names and dots of the rows above."""

    def __init__(self) -> None:
        self._names: set[str] = set()
        self._dots: set[tuple[int, int | None]] = set()

    def repeated(self, row: int, newest: ControlPoint) -> list[RowError]:
        """What of a row stands in an earlier one too."""
        errors = []
        if newest.name in self._names:
            errors.append(RowError(row, "name", f"{newest.name!r} stands in an earlier row too; names are unique"))
        if (newest.code, newest.cell) in self._dots:
            message = f"dot {newest.dot} of code {newest.code} stands in an earlier row too"
            errors.append(RowError(row, "dot", message))
        self._names.add(newest.name)
        self._dots.add((newest.code, newest.cell))
        return errors
