"""A snapshot as it is asked for."""

from __future__ import annotations

from dataclasses import dataclass, field

from app.geometry.camera import CalibratedCamera
from app.services.capture_time import ClientClock


@dataclass(frozen=True)
class LocateRequest:
    """A snapshot and what its client says of it.

    Attributes
    ----------
    photo : bytes
    site_id : str
    device_id, snapshot_id, trajectory_id, camera_id : str or None
    client_camera : CalibratedCamera or None
        Intrinsics that the client sent.
    clock : ClientClock
    """

    photo: bytes
    site_id: str
    device_id: str | None = None
    snapshot_id: str | None = None
    trajectory_id: str | None = None
    camera_id: str | None = None
    client_camera: CalibratedCamera | None = None
    clock: ClientClock = field(default_factory=ClientClock)
