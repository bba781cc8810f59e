"""A trajectory: poses of one device over time, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

Array = npt.NDArray[np.float64]

UNIT_TOLERANCE = 1e-6  # of a quaternion's length; files round to nine digits


@dataclass(frozen=True)
class Trajectory:
    """N poses ``site_from_cam`` in the order of time; of a system under test perhaps positions alone.

    Attributes
    ----------
    times_s : ndarray of shape (N,)
        UTC, seconds since 1970, never decreasing.
    positions_m : ndarray of shape (N, 3)
        Projection centres in the site frame.
    orientations_xyzw : ndarray of shape (N, 4) or None
        Unit quaternions of site_from_cam; None when the source told positions only.
    covariances : ndarray of shape (N, 6, 6) or None
        Position (m, site axes), small rotation (rad, site axes); of shape (N, 3, 3), position alone, when there are no
        orientations. None when the source of the poses told none.
    floors : ndarray of int, shape (N,), or None
        Storey of each pose, when the source told it.
    arrived_s : ndarray of shape (N,) or None
        When each pose was there to be used, by the clock of ``times_s``; None when the source told only when it holds.
    """

    times_s: Array
    positions_m: Array
    orientations_xyzw: Array | None = None
    covariances: Array | None = None
    floors: npt.NDArray[np.int64] | None = None
    arrived_s: Array | None = None

    def __post_init__(self) -> None:
        count = len(self.times_s)
        _check("times_s", self.times_s, (count,))
        _check("positions_m", self.positions_m, (count, 3))
        if self.covariances is not None:
            freedoms = 3 if self.orientations_xyzw is None else 6
            _check("covariances", self.covariances, (count, freedoms, freedoms))
        if self.floors is not None and self.floors.shape != (count,):
            raise ValueError(f"floors of {count} poses takes the shape ({count},), got {self.floors.shape}")
        if self.arrived_s is not None:
            _check("arrived_s", self.arrived_s, (count,))
        if (np.diff(self.times_s) < 0).any():
            raise ValueError("times_s must not decrease; sort the poses by time")
        if self.orientations_xyzw is not None:
            _check("orientations_xyzw", self.orientations_xyzw, (count, 4))
            if (np.abs(np.linalg.norm(self.orientations_xyzw, axis=1) - 1.0) > UNIT_TOLERANCE).any():
                raise ValueError("orientations_xyzw takes unit quaternions")

    def __len__(self) -> int:
        return len(self.times_s)

    @property
    def sigmas(self) -> Array | None:
        """Standard deviations of position (m) and small rotation (rad), shape (N, 6); None without covariances.

        Without orientations the shape is (N, 3).
        """
        return None if self.covariances is None else np.sqrt(np.diagonal(self.covariances, axis1=1, axis2=2))

    @property
    def position_covariances_m2(self) -> Array | None:
        """Covariances of the positions, shape (N, 3, 3); None without covariances."""
        return None if self.covariances is None else self.covariances[:, :3, :3]

    @property
    def rotations(self) -> Array | None:
        """Rotation matrices of site_from_cam, shape (N, 3, 3); None without orientations."""
        return None if self.orientations_xyzw is None else Rotation.from_quat(self.orientations_xyzw).as_matrix()

    @classmethod
    def empty(cls) -> Trajectory:
        """No poses."""
        return cls(np.zeros(0), np.zeros((0, 3)))

    def shifted(self, offset_s: float) -> Trajectory:
        """The same poses by a clock that reads ``offset_s`` more."""
        arrived_s = None if self.arrived_s is None else self.arrived_s + offset_s
        return replace(self, times_s=self.times_s + offset_s, arrived_s=arrived_s)

    def take(self, rows: npt.NDArray[np.intp]) -> Trajectory:
        """The poses of these rows, which must be in the order of time; a row may come more than once."""
        return Trajectory(
            self.times_s[rows],
            self.positions_m[rows],
            None if self.orientations_xyzw is None else self.orientations_xyzw[rows],
            None if self.covariances is None else self.covariances[rows],
            None if self.floors is None else self.floors[rows],
            None if self.arrived_s is None else self.arrived_s[rows],
        )


def _check(name: str, array: Array, shape: tuple[int, ...]) -> None:
    if array.shape != shape:
        raise ValueError(f"{name} of {shape[0]} poses takes the shape {shape}, got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} takes finite numbers")
