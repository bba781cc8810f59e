"""Which camera took a snapshot: the best that is known of it, best first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from app.errors import NotLocated
from app.geometry.camera import CalibratedCamera, CameraIdentity
from app.photogrammetry.camera_for_photo import cameras_for_photo
from app.photogrammetry.camera_prior import camera_from_exif, camera_of_model
from app.storage.records import StoredCamera
from app.vision.photo import PhotoHeader


@dataclass(frozen=True)
class KnownCameras:
    """What is known before the photograph is looked at.

    Attributes
    ----------
    device_id : str or None
        Who took the snapshot.
    named : CalibratedCamera or None
        The camera that the client named.
    client : CalibratedCamera or None
        The intrinsics that the client sent.
    stored : tuple of StoredCamera
        Those of the site and of the device, newest first.
    """

    device_id: str | None = None
    named: CalibratedCamera | None = None
    client: CalibratedCamera | None = None
    stored: tuple[StoredCamera, ...] = ()


def choose_cameras(header: PhotoHeader, known: KnownCameras) -> tuple[CalibratedCamera, ...]:
    """The camera at the photograph's size; two, one per quarter turn, when the photograph lies on its side.

    Raises
    ------
    NotLocated
        Reason ``unknown-camera`` when nothing is known, or only another cut of the sensor.
    """
    chosen = _best(header, known)
    return cameras_for_photo(chosen, header.width_px, header.height_px)


def _best(header: PhotoHeader, known: KnownCameras) -> CalibratedCamera:
    """The order of pipeline.md, section 2; a client's own numbers come before those of another unit."""
    if known.named is not None:
        return known.named
    fitting = [camera for camera in known.stored if _fits(camera.calibrated, header)]
    own = [camera for camera in fitting if _same_unit(camera, header, known.device_id)]
    if own:
        return min(own, key=partial(_order, device_id=known.device_id)).calibrated
    if known.client is not None:
        return known.client
    return _of_another_unit(header, fitting)


def _order(camera: StoredCamera, device_id: str | None) -> tuple[bool, bool]:
    """First the named device's own, then surveys before calibrations; the newest first among equals, as they come."""
    return device_id is not None and camera.device_id != device_id, camera.calibrated.source != "survey"


def _of_another_unit(header: PhotoHeader, fitting: Sequence[StoredCamera]) -> CalibratedCamera:
    """A camera of the same model; for a photograph that names none, the only one of its size; else EXIF's word."""
    same_model = [camera for camera in fitting if _lens(camera.identity) == _lens(header.identity)]
    lenses = {_lens(camera.identity) for camera in fitting}
    if same_model or (not header.has_exif and len(lenses) == 1):
        return camera_of_model((same_model or list(fitting))[0].calibrated)
    return camera_from_exif(header.identity)


def _same_unit(camera: StoredCamera, header: PhotoHeader, device_id: str | None) -> bool:
    """Whether this very camera took the photograph.

    EXIF tells models apart, not units, so two devices that are both named must be the same. A photograph without EXIF
    is believed to come from the camera of the device that is named.
    """
    if device_id is not None and camera.device_id is not None and device_id != camera.device_id:
        return False
    if header.has_exif:
        same_size = {camera.identity.width_px, camera.identity.height_px} == {header.width_px, header.height_px}
        return same_size and _lens(camera.identity) == _lens(header.identity)
    return device_id is not None and device_id == camera.device_id


def _fits(calibrated: CalibratedCamera, header: PhotoHeader) -> bool:
    """Whether the photograph shows the same cut of the sensor."""
    try:
        cameras_for_photo(calibrated, header.width_px, header.height_px)
    except NotLocated:
        return False
    return True


def _lens(identity: CameraIdentity) -> str:
    """A camera at one setting, whatever the size of the picture."""
    return replace(identity, width_px=1, height_px=1).key
