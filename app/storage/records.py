"""What is kept of sites, surveys, maps and cameras: frozen values without a trace of the database."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.geometry.camera import CalibratedCamera, CameraIdentity
from app.geometry.pose import Pose
from app.geometry.target_map import TargetMap

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class GeoAnchor:
    """Where the site frame's origin stands on the Earth (WGS 84).

    Attributes
    ----------
    latitude_deg, longitude_deg : float
    height_m : float
        Above the ellipsoid.
    azimuth_deg : float
        Direction of the site's Y axis, clockwise from true north.
    """

    latitude_deg: float
    longitude_deg: float
    height_m: float = 0.0
    azimuth_deg: float = 0.0


class Keep(Enum):
    """Which snapshots' pictures a site keeps."""

    NONE = "none"
    FAILURES = "failures"
    ALL = "all"

    def wants(self, *, located: bool) -> bool:
        """Whether the picture of a snapshot is kept, which was located or was not."""
        return self is Keep.ALL or (self is Keep.FAILURES and not located)


@dataclass(frozen=True)
class KeepingPolicy:
    """Which snapshots' pictures a site keeps, and for how long.

    Attributes
    ----------
    retention_s : float or None
        From the moment they come; None until they are deleted.
    """

    keep: Keep = Keep.NONE
    retention_s: float | None = None

    def __post_init__(self) -> None:
        if self.retention_s is not None and not 0 < self.retention_s < math.inf:
            raise InvalidInput(
                f"pictures are kept for a positive number of seconds or, with null, until they are deleted, "
                f"not for {self.retention_s}",
                field="snapshot_retention_s",
            )


@dataclass(frozen=True)
class Site:
    """A place whose targets share one frame, one code family and one nominal size.

    Attributes
    ----------
    plate_u_m : float
        Nominal module of the plates, metres.
    active_version : int or None
        Version of the target map that snapshots are located in; None before the first.
    created_s : float
        UTC, seconds since 1970, as all times of these records.
    """

    site_id: str
    name: str
    code_family: str
    plate_u_m: float
    geo_anchor: GeoAnchor | None
    active_version: int | None
    created_s: float
    keeping: KeepingPolicy = KeepingPolicy()


@dataclass(frozen=True)
class Survey:
    """One set of photographs of a site; ``device_id`` is the device that took them, when it is known."""

    survey_id: str
    site_id: str
    note: str
    device_id: str | None
    created_s: float


@dataclass(frozen=True)
class StoredPhoto:
    """A photograph of a survey.

    Attributes
    ----------
    sha256, size_bytes : str, int
        Of what is in the photo store, without any position on the Earth.
    sent_sha256, sent_bytes : str, int
        Of what the client sent: the same, unless that held a position.
    """

    name: str
    sha256: str
    size_bytes: int
    sent_sha256: str
    sent_bytes: int
    identity: CameraIdentity
    captured_at: str | None
    created_s: float


@dataclass(frozen=True)
class PhotoResult:
    """What became of one photograph in an adjustment.

    Attributes
    ----------
    site_from_cam : Pose or None
        None when the photograph could not be oriented; ``reason`` then says why.
    covariance : ndarray of shape (6, 6) or None
        Of the pose: position (m, site axes), small rotation (rad, site axes).
    codes : tuple of int or None
        Of the targets that took part, ascending; None when it is not known, as of maps of earlier releases.
    """

    name: str
    camera_key: str | None = None
    site_from_cam: Pose | None = None
    covariance: Array | None = None
    rms_px: float | None = None
    target_count: int | None = None
    reason: str | None = None
    codes: tuple[int, ...] | None = None


@dataclass(frozen=True)
class NewCamera:
    """A calibrated camera on its way into the database."""

    identity: CameraIdentity
    calibrated: CalibratedCamera
    device_id: str | None = None


@dataclass(frozen=True)
class StoredCamera:
    """A calibrated camera, where it was calibrated and whose it is."""

    camera_id: str
    identity: CameraIdentity
    calibrated: CalibratedCamera
    device_id: str | None
    site_id: str | None
    map_version: int | None
    created_s: float


@dataclass(frozen=True)
class Origin:
    """What a map version was made from."""

    survey_id: str
    job_id: str
    base_version: int | None = None


@dataclass(frozen=True)
class Publication:
    """All that one build publishes, written as a whole."""

    target_map: TargetMap
    origin: Origin
    cameras: tuple[NewCamera, ...]
    photos: tuple[PhotoResult, ...]
    report: dict[str, Any]


@dataclass(frozen=True)
class MapVersion:
    """A published version of a target map, without its targets."""

    version: int
    survey_id: str | None
    base_version: int | None
    target_count: int
    created_s: float
    active: bool
