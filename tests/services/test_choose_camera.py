"""Which camera is believed to have taken a snapshot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import NotLocated
from app.geometry.camera import CameraIdentity
from app.services.choose_camera import KnownCameras, choose_cameras
from app.storage.records import StoredCamera
from app.vision.photo import PhotoHeader
from tests.storage.examples import IDENTITY, calibrated

ANONYMOUS = CameraIdentity("", "", 1280, 720)


def header(identity: CameraIdentity) -> PhotoHeader:
    return PhotoHeader(identity.width_px, identity.height_px, "JPEG", identity, None, identity.make != "")


def stored(seed: int, device_id: str | None, identity: CameraIdentity = IDENTITY) -> StoredCamera:
    camera = calibrated(seed=seed)
    sized = replace(camera, camera=replace(camera.camera, width_px=identity.width_px, height_px=identity.height_px))
    return StoredCamera(f"camera-{seed}", identity, sized, device_id, "site", 1, 0.0)


def chosen(identity: CameraIdentity, known: KnownCameras) -> tuple[str, float]:
    (camera,) = choose_cameras(header(identity), known)
    return camera.source, camera.camera.fx_px


def test_a_named_camera_comes_before_all_others() -> None:
    known = KnownCameras("phone-1", calibrated("calibration", 1), calibrated("client", 2), (stored(3, "phone-1"),))
    assert chosen(IDENTITY, known) == ("calibration", 1001.0)


@pytest.mark.parametrize(
    ("snapshot_device", "camera_device"), [("phone-1", "phone-1"), (None, None), ("phone-1", None), (None, "phone-1")]
)
def test_the_surveys_camera_is_used_for_its_own_device(snapshot_device: str | None, camera_device: str | None) -> None:
    known = KnownCameras(snapshot_device, None, calibrated("client", 2), (stored(3, camera_device),))
    assert chosen(IDENTITY, known) == ("survey", 1003.0)


def test_another_unit_of_the_model_is_less_certain_and_said_so() -> None:
    known = KnownCameras("phone-2", None, None, (stored(3, "phone-1"),))
    (camera,) = choose_cameras(header(IDENTITY), known)
    assert camera.source == "model"
    focal_sigma = np.sqrt(camera.covariance[0, 0]) / camera.camera.fx_px
    assert focal_sigma >= 0.005  # pipeline.md, section 2


def test_the_clients_own_numbers_come_before_another_units() -> None:
    known = KnownCameras("phone-2", None, calibrated("client", 2), (stored(3, "phone-1"),))
    assert chosen(IDENTITY, known) == ("client", 1002.0)


def test_a_new_camera_falls_back_on_exif_and_says_so() -> None:
    other = replace(IDENTITY, model="Model 4")
    source, focal_px = chosen(other, KnownCameras(None, None, None, (stored(3, None),)))
    assert source == "exif"
    assert focal_px == pytest.approx(27.0 / 36.0 * 1280, rel=0.05)


def test_another_zoom_is_another_camera() -> None:
    assert chosen(replace(IDENTITY, zoom=3.0), KnownCameras(None, None, None, (stored(3, None),)))[0] == "exif"


def test_the_newest_of_several_wins() -> None:
    known = KnownCameras(None, None, None, (stored(7, None), stored(3, None)))
    assert chosen(IDENTITY, known) == ("survey", 1007.0)


def test_a_photograph_without_exif_is_believed_to_be_its_devices() -> None:
    known = KnownCameras("phone-1", None, None, (stored(3, "phone-1"),))
    assert chosen(ANONYMOUS, known) == ("survey", 1003.0)


def test_a_photograph_without_exif_or_device_takes_the_only_camera_of_its_size_with_caution() -> None:
    assert chosen(ANONYMOUS, KnownCameras(stored=(stored(3, None),)))[0] == "model"


@pytest.mark.parametrize(
    "cameras",
    [
        (),
        (stored(3, None), stored(4, None, replace(IDENTITY, model="Model 4"))),  # which of the two?
        (stored(3, None, replace(IDENTITY, width_px=1000, height_px=1000)),),  # another cut of the sensor
    ],
)
def test_a_photograph_that_nothing_is_known_of_is_refused(cameras: tuple[StoredCamera, ...]) -> None:
    with pytest.raises(NotLocated) as refused:
        choose_cameras(header(ANONYMOUS), KnownCameras(stored=cameras))
    assert refused.value.fields["reason"] == "unknown-camera"
    assert refused.value.fields["advice"]


@pytest.mark.parametrize("device_id", [None, "phone-1"])
def test_a_picture_on_its_side_is_tried_in_both_quarter_turns(device_id: str | None) -> None:
    on_its_side = replace(ANONYMOUS, width_px=720, height_px=1280)
    cameras = choose_cameras(header(on_its_side), KnownCameras(device_id, stored=(stored(3, "phone-1"),)))
    assert [camera.camera.width_px for camera in cameras] == [720, 720]
    first, second = (camera.camera.intrinsics for camera in cameras)
    assert first[2] == pytest.approx(719 - second[2])  # the two turns are half a turn apart
    assert {camera.source for camera in cameras} == {"survey" if device_id else "model"}
