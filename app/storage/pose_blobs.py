"""Many poses as few rows: arrays of some thousand poses each, so that a million are read without a row for each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from app.storage.blobs import array_of_blob, blob_of_array
from app.trajectories.trajectory import Array, Trajectory

POSES_A_ROW = 4096  # at most 1 MB with covariances: a page of a hundred reads one or two


def pieces_of(trajectory: Trajectory) -> Iterator[tuple[int, Trajectory]]:
    """Consecutive pieces that a row takes, each with the row (from 0) of its first pose."""
    for first in range(0, len(trajectory), POSES_A_ROW):
        yield first, trajectory.take(np.arange(first, min(first + POSES_A_ROW, len(trajectory))))


def pose_columns(piece: Trajectory) -> dict[str, Any]:
    """A piece as the columns of ``PoseColumns``; of covariances the upper triangle."""
    floors = piece.floors
    return {
        "pose_count": len(piece),
        "times_s": blob_of_array(piece.times_s),
        "positions_m": blob_of_array(piece.positions_m),
        "orientations_xyzw": None if piece.orientations_xyzw is None else blob_of_array(piece.orientations_xyzw),
        "covariances": None if piece.covariances is None else blob_of_array(_upper(piece.covariances)),
        "floors": None if floors is None else blob_of_array(floors.astype(np.float64)),
        "arrived_s": None if piece.arrived_s is None else blob_of_array(piece.arrived_s),
    }


def poses_of_row(row: Any) -> Trajectory:
    """The piece of ``pose_columns``.

    Raises
    ------
    ValueError
        When the columns do not fit each other.
    """
    count, turned = row.pose_count, row.orientations_xyzw is not None
    floors = None if row.floors is None else array_of_blob(row.floors, count)
    return Trajectory(
        times_s=array_of_blob(row.times_s, count),
        positions_m=array_of_blob(row.positions_m, count, 3),
        orientations_xyzw=array_of_blob(row.orientations_xyzw, count, 4) if turned else None,
        covariances=None if row.covariances is None else _full(row.covariances, count, 6 if turned else 3),
        floors=None if floors is None else floors.astype(np.int64),
        arrived_s=None if row.arrived_s is None else array_of_blob(row.arrived_s, count),
    )


def joined(pieces: Sequence[Trajectory]) -> Trajectory:
    """Consecutive pieces, one at least, as one trajectory; all tell the same of their poses."""
    first = pieces[0]
    return Trajectory(
        np.concatenate([piece.times_s for piece in pieces]),
        np.concatenate([piece.positions_m for piece in pieces]),
        None if first.orientations_xyzw is None else _together([piece.orientations_xyzw for piece in pieces]),
        None if first.covariances is None else _together([piece.covariances for piece in pieces]),
        None if first.floors is None else _together([piece.floors for piece in pieces]),
        None if first.arrived_s is None else _together([piece.arrived_s for piece in pieces]),
    )


def _together(arrays: Sequence[Any]) -> Any:
    return np.concatenate(arrays)


def _upper(covariances: Array) -> Array:
    rows, columns = np.triu_indices(covariances.shape[-1])
    return covariances[:, rows, columns]


def _full(blob: bytes, count: int, freedoms: int) -> Array:
    rows, columns = np.triu_indices(freedoms)
    upper = array_of_blob(blob, count, len(rows))
    covariances = np.empty((count, freedoms, freedoms))
    covariances[:, rows, columns] = upper
    covariances[:, columns, rows] = upper
    return covariances
