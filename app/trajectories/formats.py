"""Trajectories as text, written part by part, so that a million poses never stand in memory.

The parts are consecutive pieces of one trajectory, none of them empty. Positions are written to the micrometre,
quaternions to 1e-9, times to the microsecond.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from itertools import repeat
from typing import Any

import numpy as np
import numpy.typing as npt

from app.trajectories.trajectory import Array, Trajectory

SIGMA_COLUMNS = ("sigma_x_m", "sigma_y_m", "sigma_z_m", "sigma_rx_rad", "sigma_ry_rad", "sigma_rz_rad")
COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")  # m and rad
# The upper triangle of the covariance, row by row.
COVARIANCE_COLUMNS = tuple(
    f"cov_{first}_{second}" for row, first in enumerate(COMPONENTS) for second in COMPONENTS[row:]
)
POSITION_COLUMNS, QUATERNION_COLUMNS = ("x_m", "y_m", "z_m"), ("qx", "qy", "qz", "qw")
UNCERTAINTY_COLUMNS = (*SIGMA_COLUMNS, *COVARIANCE_COLUMNS)
CSV_COLUMNS = ("time_utc", "time_s", *POSITION_COLUMNS, *QUATERNION_COLUMNS, *UNCERTAINTY_COLUMNS)
FLOOR_COLUMN, ARRIVED_COLUMN = "floor", "arrived_s"
CSV_POSITION, CSV_TURN, CSV_NO_TURN = "%.6f,%.6f,%.6f,%.6f", ",%.9f,%.9f,%.9f,%.9f", ",,,,"
DEGREE_DIGITS = 9  # 0.1 mm on the ground
HEIGHT_DIGITS, METRES_DIGITS = 4, 6  # 0.1 mm, a micrometre
COVARIANCE_DIGITS = 7  # significant ones, as in CSV


def csv_text(parts: Iterable[Trajectory]) -> Iterator[str]:
    """One line per pose under a heading; what a trajectory does not tell stays empty.

    Storeys and arrivals have a column if told.

    ``time_s`` counts from 1970 in UTC; ``time_utc`` says the same for people. Sigmas are the roots of the covariance's
    diagonal; ``cov_x_ry`` is in m rad.
    """
    heading = ",".join(CSV_COLUMNS)
    for part in parts:
        if heading:
            told = ((FLOOR_COLUMN, part.floors), (ARRIVED_COLUMN, part.arrived_s))
            yield ",".join([heading, *(name for name, values in told if values is not None)]) + "\n"
            heading = ""
        columns = (_position_texts(part), _turn_texts(part), _sigma_texts(part), _floor_texts(part), _arrived(part))
        yield "".join(f"{''.join(pieces)}\n" for pieces in zip(*columns, strict=True))
    if heading:
        yield heading + "\n"


def geojson_text(
    parts: Iterable[Trajectory], geodetic: Callable[[Array], Array], members: dict[str, Any]
) -> Iterator[str]:
    """A feature collection with one point per pose (RFC 7946).

    Parameters
    ----------
    parts : iterable of Trajectory
    geodetic : callable
        Takes positions of shape (N, 3) of the site frame to longitude (deg), latitude (deg) and height (m).
    members : dict
        What the collection says of itself beside its features.
    """
    head = json.dumps({"type": "FeatureCollection", **members})
    yield head[:-1] + ', "features": ['
    separator = ""
    for part in parts:
        features = _features(part, geodetic(part.positions_m))
        yield separator + ",\n".join(json.dumps(feature) for feature in features)
        separator = ",\n"
    yield "]}\n"


def iso_times(times_s: Array) -> npt.NDArray[np.str_]:
    """ISO 8601 in UTC to the microsecond, shape (N,), of seconds since 1970."""
    microseconds = np.round(times_s * 1e6).astype(np.int64)
    return np.datetime_as_string(microseconds.astype("datetime64[us]"), unit="us", timezone="UTC")


def _position_texts(part: Trajectory) -> Iterator[str]:
    rows = np.column_stack([part.times_s, part.positions_m]).tolist()
    return (
        f"{time_utc},{CSV_POSITION % tuple(row)}" for time_utc, row in zip(iso_times(part.times_s), rows, strict=True)
    )


def _turn_texts(part: Trajectory) -> Iterator[str]:
    if part.orientations_xyzw is None:
        return repeat(CSV_NO_TURN, len(part))
    return (CSV_TURN % tuple(row) for row in part.orientations_xyzw.tolist())


def _sigma_texts(part: Trajectory) -> Iterator[str]:
    """Sigmas and covariances; those of a rotation that is not known stay empty."""
    sigmas, covariances = part.sigmas, part.covariances
    if sigmas is None or covariances is None:
        return repeat("," * len(UNCERTAINTY_COLUMNS), len(part))
    freedoms = sigmas.shape[1]
    rows, columns = np.triu_indices(len(COMPONENTS))
    known = np.append(np.arange(len(COMPONENTS)) < freedoms, (rows < freedoms) & (columns < freedoms))
    line = "".join(",%.7g" if told else "," for told in known)
    upper = covariances[:, *np.triu_indices(freedoms)]
    return (line % tuple(row) for row in np.hstack([sigmas, upper]).tolist())


def _floor_texts(part: Trajectory) -> Iterator[str]:
    if part.floors is None:
        return repeat("", len(part))
    return (f",{floor}" for floor in part.floors.tolist())


def _arrived(part: Trajectory) -> Iterator[str]:
    if part.arrived_s is None:
        return repeat("", len(part))
    return (f",{arrived_s:.6f}" for arrived_s in part.arrived_s.tolist())


def _features(part: Trajectory, geodetic: Array) -> Iterator[dict[str, Any]]:
    degrees = np.round(geodetic[:, :2], DEGREE_DIGITS)
    coordinates = np.column_stack([degrees, np.round(geodetic[:, 2], HEIGHT_DIGITS)]).tolist()
    properties: dict[str, list[Any]] = {
        "time": iso_times(part.times_s).tolist(),
        "position_m": np.round(part.positions_m, METRES_DIGITS).tolist(),
    }
    if part.orientations_xyzw is not None:
        properties["orientation_xyzw"] = part.orientations_xyzw.tolist()
    if part.floors is not None:
        properties["floor"] = part.floors.tolist()
    if part.arrived_s is not None:
        properties["arrived"] = iso_times(part.arrived_s).tolist()
    if part.sigmas is not None and part.covariances is not None:
        properties["position_sigma_m"] = part.sigmas[:, :3].tolist()
        properties["covariance"] = _significant(part.covariances).tolist()
    for row, place in enumerate(coordinates):
        point = {"type": "Point", "coordinates": place}
        told = {name: values[row] for name, values in properties.items()}
        yield {"type": "Feature", "geometry": point, "properties": told}


def _significant(values: Array) -> Array:
    """Values rounded to the digits that are worth writing."""
    sizes = np.abs(values)
    powers = np.floor(np.log10(sizes, out=np.zeros_like(sizes), where=sizes > 0))
    steps = 10.0 ** (COVARIANCE_DIGITS - 1 - powers)
    return np.asarray(np.round(values * steps) / steps)
