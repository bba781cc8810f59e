"""Snapshots as they are kept: where a device was, or why nobody knows, and what was seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose

Array = npt.NDArray[np.float64]
TimeSource = Literal["client", "server"]

INCONSISTENT = "inconsistent"  # the refusal of targets that agree on no pose


@dataclass(frozen=True)
class Moment:
    """When a snapshot was taken.

    Attributes
    ----------
    captured_s : float
        UTC, seconds since 1970.
    source : str
        ``client``: the client said so; ``server``: it did not, so it is the time of arrival.
    clock_delay_s : float or None
        Half the round trip of the client's clock comparison: how far its offset can be wrong.
    """

    captured_s: float
    source: TimeSource
    clock_delay_s: float | None = None


@dataclass(frozen=True)
class Heading:
    """Where a snapshot belongs."""

    site_id: str
    map_version: int
    moment: Moment
    received_s: float
    device_id: str | None = None
    snapshot_id: str | None = None


@dataclass(frozen=True)
class SeenTarget:
    """A target of the snapshot: how well it was read and whether its dots carried the pose."""

    code: int
    corrected: int
    rms_px: float | None
    used: bool
    reason: str | None = None


@dataclass(frozen=True)
class RefusedBlob:
    """Something in the picture that was looked at and refused."""

    reason: str
    centre_px: tuple[float, float]
    code: int | None = None


@dataclass(frozen=True)
class Seen:
    """What a snapshot showed, and how long the work took, stage by stage in ms."""

    targets: tuple[SeenTarget, ...] = ()
    rejected: tuple[RefusedBlob, ...] = ()
    timing_ms: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Focal:
    """What a snapshot and what was known before together say of the focal length along x."""

    px: float
    sigma_px: float


@dataclass(frozen=True)
class RollingShutter:
    """What a movement of the camera did to a pose, or may have done.

    Attributes
    ----------
    modelled : bool
        Whether the sensor's readout was known, and the movement taken out.
    readout_s : float
        The readout; a typical one where it is not known.
    position_m_per_m_s, position_m_per_rad_s : float
        By how much a movement that is not taken out shifts the position, in the worst direction.
    motion, motion_sigmas : tuple of 6 floats or None
        Velocity (m/s) and angular velocity (rad/s), site axes, that were taken out.
    """

    modelled: bool
    readout_s: float
    position_m_per_m_s: float
    position_m_per_rad_s: float
    motion: tuple[float, ...] | None = None
    motion_sigmas: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Located:
    """A pose that was found.

    Attributes
    ----------
    site_from_cam : Pose
    covariance : ndarray of shape (6, 6)
        Position (m, site axes), small rotation (rad, site axes).
    focal, rolling_shutter
        None in poses that were kept before they were told.
    """

    site_from_cam: Pose
    covariance: Array
    sigma0: float
    redundancy: int
    rms_residual_px: float
    camera_source: str
    ambiguity_ratio: float | None = None
    focal: Focal | None = None
    rolling_shutter: RollingShutter | None = None

    @property
    def position_sigma_m(self) -> Array:
        """Standard deviations of the position, shape (3,)."""
        return np.sqrt(np.diag(self.covariance)[:3])


@dataclass(frozen=True)
class NotFoundPose:
    """Why there is no pose, for programs (``reason``) and for people."""

    reason: str
    detail: str
    advice: str


@dataclass(frozen=True)
class NewSnapshot:
    """A snapshot on its way into the database.

    Attributes
    ----------
    evidence : bytes or None
        What it tells of the map (``evidence_blob``); None when that is not to be kept.
    """

    heading: Heading
    outcome: Located | NotFoundPose
    seen: Seen
    evidence: bytes | None = None

    @property
    def tells_of_map(self) -> bool:
        """Whether it stands in the evidence: also when its targets contradict each other."""
        contradicts = isinstance(self.outcome, NotFoundPose) and self.outcome.reason == INCONSISTENT
        return self.evidence is not None or contradicts


@dataclass(frozen=True)
class Snapshot:
    """A stored snapshot: a row of its trajectory."""

    pose_id: str
    trajectory_id: str
    heading: Heading
    outcome: Located | NotFoundPose
    seen: Seen
