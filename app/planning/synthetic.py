"""Synthetic photographs: a scene, a camera and a pose in; a JPEG and the truth about it out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.geometry.camera import Camera, CameraIdentity
from app.geometry.pose import Pose
from app.planning.imaging import ImagingOptions, digitise, expose
from app.planning.painting import PaintingOptions, paint
from app.planning.photo_file import encode_jpeg
from app.planning.scene import Scene
from app.planning.sight import SeenTarget, see

FULL_FRAME_WIDTH_MM = 36.0  # of the 35 mm film that EXIF's equivalent focal length refers to


@dataclass(frozen=True)
class RenderedPhoto:
    """A synthetic photograph with its truth.

    Attributes
    ----------
    jpeg : bytes
        With EXIF.
    identity : CameraIdentity
        What a reader of the file's EXIF finds.
    site_from_cam : Pose
    targets : tuple of SeenTarget
        All with at least one dot seen wholly, in the scene's order.
    """

    jpeg: bytes
    identity: CameraIdentity
    site_from_cam: Pose
    targets: tuple[SeenTarget, ...]

    def whole_codes(self) -> frozenset[int]:
        """Codes of the right plates that are seen wholly."""
        return frozenset(target.code for target in self.targets if target.whole and not target.wrong)


def render(scene: Scene, camera: Camera, site_from_cam: Pose, imaging: ImagingOptions, seed: int) -> RenderedPhoto:
    """Take a photograph of a scene; the same arguments give the same bytes.

    Parameters
    ----------
    scene : Scene
    camera : Camera
        Size, intrinsics and distortion.
    site_from_cam : Pose
        Where it stands.
    imaging : ImagingOptions
        Blur, exposure, noise, tone, file.
    seed : int
        Of the noise.
    """
    sensor = expose(paint(scene, camera, site_from_cam, PaintingOptions()), imaging)
    rgb = digitise(sensor, imaging, np.random.default_rng(seed))
    identity = identity_of(camera, imaging)
    return RenderedPhoto(
        encode_jpeg(rgb, imaging, identity), identity, site_from_cam, see(scene, camera, site_from_cam)
    )


def identity_of(camera: Camera, imaging: ImagingOptions) -> CameraIdentity:
    """What the EXIF of this camera's photographs says; the 35 mm equivalent by width, in whole millimetres."""
    return CameraIdentity(
        make=imaging.make,
        model=imaging.model,
        width_px=camera.width_px,
        height_px=camera.height_px,
        focal_mm=imaging.focal_mm,
        focal_35mm=float(round(camera.fx_px / max(camera.width_px, camera.height_px) * FULL_FRAME_WIDTH_MM)),
    )
