"""A snapshot's parameters and its answer."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal
from uuid import UUID

import numpy as np
from pydantic import AfterValidator, BaseModel, Field, Json

from app.api.dependencies import Id
from app.api.schemas.common import WHOLE, Body, Finite, Quaternion, Vector3, numbers_of, time_of
from app.api.schemas.texts import Text
from app.geometry.camera import CalibratedCamera, Camera
from app.geometry.readout import Readout
from app.geometry.rotation import photogrammetric_angles_deg
from app.photogrammetry.camera_prior import camera_from_client
from app.services.capture_time import ClientClock
from app.services.locate import LocateRequest
from app.storage.snapshots import Located, RollingShutter, Snapshot

GREATEST_SIDE_PX = 100_000
GREATEST_OFFSET_S = 1e10  # an epoch of 1970 instead of none: device clocks may begin anywhere
DISTORTION_COUNTS = (0, 4, 5)  # none, k1 k2 p1 p2, or with k3

Side = Annotated[int, Field(strict=True, ge=1, le=GREATEST_SIDE_PX), WHOLE]
Focal = Annotated[Finite, Field(gt=0)]


def _distortion(dist: list[float]) -> list[float]:
    if len(dist) not in DISTORTION_COUNTS:
        raise ValueError("takes k1, k2, p1, p2 and k3 (OpenCV's order), or none")
    return dist


class ClientCamera(Body):
    """Intrinsics as the client knows them, for one image size."""

    width_px: Side
    height_px: Side
    fx: Focal
    fy: Focal
    cx: Finite
    cy: Finite
    dist: Annotated[list[Finite], AfterValidator(_distortion)] = Field(default_factory=list)
    readout_s: Annotated[Finite | None, Field(ge=0, le=1)] = None

    def to_domain(self) -> CalibratedCamera:
        """The camera with a client's uncertainty."""
        distortion = [*self.dist, *[0.0] * (DISTORTION_COUNTS[-1] - len(self.dist))]
        intrinsics = np.array([self.fx, self.fy, self.cx, self.cy, *distortion])
        camera = Camera(self.width_px, self.height_px, intrinsics)
        known = camera_from_client(camera, distortion_known=bool(self.dist))
        return known if self.readout_s is None else replace(known, readout=Readout(self.readout_s))


class LocateParameters(BaseModel):
    """What a client says of a snapshot: fields of the form, or of the query when the image is the body."""

    site_id: Annotated[Id, Field(min_length=1)]
    device_id: Text | None = None
    snapshot_id: Annotated[UUID | None, Field(description="The client's own: a repeat gets the first answer.")] = None
    captured_at: Annotated[
        str | None, Field(max_length=100, description="ISO 8601 (UTC unless it names a zone) or epoch seconds.")
    ] = None
    client_clock_offset_s: Annotated[
        float, Field(ge=-GREATEST_OFFSET_S, le=GREATEST_OFFSET_S, description="Server UTC = captured_at + offset.")
    ] = 0.0
    client_clock_delay_s: Annotated[float | None, Field(ge=0, le=3600, description="Half the round trip.")] = None
    trajectory_id: Id | None = None
    camera_id: Id | None = None
    camera: Json[ClientCamera] | None = None

    def to_domain(self, photo: bytes) -> LocateRequest:
        """The request as services know it."""
        return LocateRequest(
            photo=photo,
            site_id=self.site_id,
            device_id=self.device_id,
            snapshot_id=None if self.snapshot_id is None else str(self.snapshot_id),
            trajectory_id=self.trajectory_id,
            camera_id=self.camera_id,
            client_camera=None if self.camera is None else self.camera.to_domain(),
            clock=ClientClock(self.captured_at, self.client_clock_offset_s, self.client_clock_delay_s),
        )


class Angles(BaseModel):
    """Photogrammetric angles; null within a degree of looking along the site's Y axis."""

    phi: float | None
    omega: float | None
    kappa: float | None


class LocateTarget(BaseModel):
    """A target of the snapshot."""

    code: int
    corrected: int
    rms_px: float | None
    used: bool
    reason: str | None = Field(description="Why it was not used.")


class LocateReject(BaseModel):
    """Something that was looked at and refused."""

    reason: str
    centre_px: Annotated[list[float], Field(min_length=2, max_length=2)]
    code: int | None


class FocalAnswer(BaseModel):
    """The focal length along x, after this snapshot."""

    px: float
    sigma_px: float


class RollingShutterAnswer(BaseModel):
    """What a movement of the camera did to the pose, or may have done."""

    modelled: bool = Field(description="Whether the readout was known, and the movement taken out.")
    readout_s: float = Field(description="Of the sensor's rows; a typical one where it is not known.")
    position_m_per_m_s: float = Field(description="What a movement shifts the position by, if it is not taken out.")
    position_m_per_rad_s: float
    velocity_m_s: Vector3 | None = Field(description="That was taken out; site axes.")
    velocity_sigma_m_s: Vector3 | None
    angular_velocity_rad_s: Vector3 | None
    angular_velocity_sigma_rad_s: Vector3 | None

    @classmethod
    def of(cls, told: RollingShutter | None) -> RollingShutterAnswer | None:
        """The answer for what was found."""
        if told is None:
            return None
        motion, sigmas = told.motion, told.motion_sigmas
        return cls(
            modelled=told.modelled,
            readout_s=told.readout_s,
            position_m_per_m_s=told.position_m_per_m_s,
            position_m_per_rad_s=told.position_m_per_rad_s,
            velocity_m_s=None if motion is None else list(motion[:3]),
            velocity_sigma_m_s=None if sigmas is None else list(sigmas[:3]),
            angular_velocity_rad_s=None if motion is None else list(motion[3:]),
            angular_velocity_sigma_rad_s=None if sigmas is None else list(sigmas[3:]),
        )


class LocateAnswer(BaseModel):
    """Where a snapshot was taken."""

    pose_id: str
    site_id: str
    map_version: int
    captured_at: str
    trajectory_id: str
    device_id: str | None
    snapshot_id: str | None
    time_source: Literal["client", "server"]
    position_m: Vector3
    orientation_xyzw: Quaternion
    angles_deg: Angles
    covariance: list[list[float]] = Field(description="6 x 6: position (m, site axes), small rotation (rad, site axes)")
    position_sigma_m: Vector3
    targets: list[LocateTarget]
    rejected: list[LocateReject]
    sigma0: float
    redundancy: int
    rms_residual_px: float
    camera_source: Literal["survey", "calibration", "client", "exif", "model"]
    ambiguity_ratio: float | None
    focal: FocalAnswer | None = Field(description="Null in poses that were kept before it was told.")
    rolling_shutter: RollingShutterAnswer | None = Field(description="Null in poses that were kept before it was told.")
    timing_ms: dict[str, float]

    @classmethod
    def of(cls, snapshot: Snapshot) -> LocateAnswer:
        """The answer for a located snapshot."""
        heading, located = snapshot.heading, snapshot.outcome
        assert isinstance(located, Located)
        pose = located.site_from_cam
        angles_deg = photogrammetric_angles_deg(pose.rotation) or (None, None, None)
        return cls.model_validate(
            {
                "pose_id": snapshot.pose_id,
                "site_id": heading.site_id,
                "map_version": heading.map_version,
                "captured_at": time_of(heading.moment.captured_s),
                "trajectory_id": snapshot.trajectory_id,
                "device_id": heading.device_id,
                "snapshot_id": heading.snapshot_id,
                "time_source": heading.moment.source,
                "position_m": numbers_of(pose.position_m),
                "orientation_xyzw": numbers_of(pose.orientation_xyzw),
                "angles_deg": dict(zip(("phi", "omega", "kappa"), angles_deg, strict=True)),
                "covariance": located.covariance.tolist(),
                "position_sigma_m": numbers_of(located.position_sigma_m),
                "targets": [vars(target) for target in snapshot.seen.targets],
                "rejected": [vars(item) for item in snapshot.seen.rejected],
                "sigma0": located.sigma0,
                "redundancy": located.redundancy,
                "rms_residual_px": located.rms_residual_px,
                "camera_source": located.camera_source,
                "ambiguity_ratio": located.ambiguity_ratio,
                "focal": None if located.focal is None else vars(located.focal),
                "rolling_shutter": RollingShutterAnswer.of(located.rolling_shutter),
                "timing_ms": dict(snapshot.seen.timing_ms),
            }
        )
