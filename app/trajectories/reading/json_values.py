"""Values of JSON files that hold poses: each error names the pose (from 1) and its member."""

from __future__ import annotations

import json
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np
import numpy.typing as npt

from app.trajectories.reading.poses import LENGTH_TOLERANCE
from app.trajectories.reading.table import GREATEST_NUMBER, GREATEST_ROWS, SHOWN, UnreadableTrajectory, text_of
from app.trajectories.trajectory import Array

GREATEST_BYTES = 128 << 20  # some 200,000 poses with covariances, 1.3 GB while they are read
SYMMETRY = 1e-6  # of a covariance's greatest element: files round to seven digits


@dataclass(frozen=True)
class GeodeticPoses:
    """Poses whose positions stand on the Earth (WGS 84).

    Attributes
    ----------
    times_s : ndarray of shape (N,)
        UTC, strictly increasing.
    places_deg_m : ndarray of shape (N, 3)
        Longitude (deg), latitude (deg), height above the ellipsoid (m); NaN for a height that the file does not tell.
    orientations_xyzw : ndarray of shape (N, 4) or None
        Of the site frame, or of east, north and up, as the format has it.
    floors : ndarray of int, shape (N,), or None
    covariances : ndarray of shape (N, 6, 6) or (N, 3, 3), or None
        In the axes of the orientations.
    arrived_s : ndarray of shape (N,) or None
    """

    times_s: Array
    places_deg_m: Array
    orientations_xyzw: Array | None = None
    floors: npt.NDArray[np.int64] | None = None
    covariances: Array | None = None
    arrived_s: Array | None = None


@dataclass(frozen=True)
class Member:
    """Where a value stands: the kind of thing that holds it, its number from 1, its name there."""

    kind: str
    number: int
    name: str

    def refuse(self, what: str) -> UnreadableTrajectory:
        """The error that points at it."""
        return UnreadableTrajectory(
            f"{self.kind} {self.number}, {self.name}: {what}", feature=self.number, column=self.name
        )


def document_of(data: bytes) -> Any:
    """The JSON of a file.

    Raises
    ------
    UnreadableTrajectory
        When it is none, or too large: as objects it takes ten times its bytes.
    """
    if len(data) > GREATEST_BYTES:
        raise UnreadableTrajectory(
            f"the file has {len(data)} bytes, and JSON is taken up to {GREATEST_BYTES}; send it in parts, or as CSV"
        )
    try:
        return json.loads(text_of(data))
    except (ValueError, RecursionError) as error:
        line = getattr(error, "lineno", 1)
        raise UnreadableTrajectory(f"line {line}: this is no JSON ({error})"[:300], line=line) from error


def listed(found: Any, whole: str) -> list[Any]:
    """A list of poses, one at least and no more than can be taken; ``whole`` says what the file should be."""
    if not isinstance(found, list) or not found:
        raise UnreadableTrajectory(f"the file is no {whole} with one pose at least; send all poses in one")
    if len(found) > GREATEST_ROWS:
        raise UnreadableTrajectory(f"the file has more than {GREATEST_ROWS} poses; send it in parts", rows=len(found))
    return found


def is_number(value: Any) -> bool:
    """Whether a value is a finite number of use; true and false are none."""
    return type(value) in (int, float) and abs(value) < GREATEST_NUMBER


def moment_s(told: Any, member: Member) -> float:
    """Seconds since 1970 of a number of them, or of ISO 8601 (UTC unless it names a zone)."""
    if is_number(told):
        return float(told)
    try:
        moment = datetime.fromisoformat(told)
    except (TypeError, ValueError) as error:
        raise member.refuse(f"{str(told)[:SHOWN]!r} is no time like 2026-03-01T12:00:00Z") from error
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def unit_quaternion(told: Any, member: Member) -> Array:
    """Four numbers x, y, z, w brought to unit length, shape (4,)."""
    if not isinstance(told, list) or len(told) != 4 or not all(is_number(value) for value in told):
        raise member.refuse("four numbers x, y, z, w are needed, as the first pose has them")
    quaternion = np.array(told, dtype=np.float64)
    length = float(np.linalg.norm(quaternion))
    if abs(length - 1.0) > LENGTH_TOLERANCE:
        raise member.refuse(f"the quaternion has the length {length:.4g}, and 1 is needed")
    return quaternion / length


def square_matrix(told: Any, size: int, member: Member) -> Array:
    """A symmetric matrix, shape (size, size), as a list of rows."""
    rows = told if isinstance(told, list) else []
    whole = len(rows) == size and all(isinstance(row, list) and len(row) == size for row in rows)
    if not whole or not all(is_number(value) for row in rows for value in row):
        raise member.refuse(f"{size} rows of {size} numbers are needed, as the first pose has them")
    matrix = np.array(rows, dtype=np.float64)
    if np.abs(matrix - matrix.T).max() > SYMMETRY * np.abs(matrix).max():
        raise member.refuse("a covariance is symmetric")
    return (matrix + matrix.T) / 2.0


def increasing(times_s: Array, kind: str, name: str) -> None:
    """See that times increase from one to the next."""
    late = np.flatnonzero(np.diff(times_s) <= 0)
    if len(late):
        member = Member(kind, int(late[0]) + 2, name)
        raise member.refuse("it is not after the one before; sort the poses by time")
