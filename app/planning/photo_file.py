"""The file a phone would write: JPEG and EXIF that tells the camera."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt
from PIL import ExifTags, Image

from app.geometry.camera import CameraIdentity
from app.planning.imaging import Chroma, ImagingOptions

SAMPLING_FACTORS: dict[Chroma, int] = {
    "4:2:0": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420,
    "4:2:2": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_422,
    "4:4:4": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444,
}
JPEG_SOI_BYTES = 2  # the segment follows the start of the image at once
JPEG_APP1, LENGTH_BYTES = b"\xff\xe1", 2
UPRIGHT = 1  # EXIF orientation


def encode_jpeg(rgb: npt.NDArray[np.uint8], imaging: ImagingOptions, identity: CameraIdentity) -> bytes:
    """The photograph's file.

    Parameters
    ----------
    rgb : ndarray of shape (H, W, 3), uint8
    imaging : ImagingOptions
        Quality, chroma, time, and whether EXIF is written.
    identity : CameraIdentity
        What EXIF says of the camera.
    """
    quality = [cv2.IMWRITE_JPEG_QUALITY, imaging.jpeg_quality]
    sampling = [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, SAMPLING_FACTORS[imaging.chroma]]
    encoded, jpeg = cv2.imencode(".jpg", np.ascontiguousarray(rgb[..., ::-1]), [*quality, *sampling])
    if not encoded:
        raise RuntimeError("OpenCV could not encode the synthetic photograph as JPEG")
    data = jpeg.tobytes()
    if not imaging.write_exif:
        return data
    exif = _exif_bytes(identity, imaging.captured_at)
    segment = JPEG_APP1 + (len(exif) + LENGTH_BYTES).to_bytes(LENGTH_BYTES, "big") + exif
    return data[:JPEG_SOI_BYTES] + segment + data[JPEG_SOI_BYTES:]


def _exif_bytes(identity: CameraIdentity, captured_at: str) -> bytes:
    exif = Image.Exif()
    exif[ExifTags.Base.Make] = identity.make
    exif[ExifTags.Base.Model] = identity.model
    exif[ExifTags.Base.Orientation] = UPRIGHT
    second, _, fraction = captured_at.partition(".")
    exif[ExifTags.Base.DateTime] = second
    camera_block = exif.get_ifd(ExifTags.IFD.Exif)
    camera_block[ExifTags.Base.DateTimeOriginal] = second
    if fraction:
        camera_block[ExifTags.Base.SubsecTimeOriginal] = fraction
    camera_block[ExifTags.Base.ExifImageWidth] = identity.width_px
    camera_block[ExifTags.Base.ExifImageHeight] = identity.height_px
    if identity.focal_mm is not None:
        camera_block[ExifTags.Base.FocalLength] = identity.focal_mm
    if identity.focal_35mm is not None:
        camera_block[ExifTags.Base.FocalLengthIn35mmFilm] = round(identity.focal_35mm)
    return bytes(exif.tobytes())
