"""A photograph: its header read before a pixel is decoded, its pixels as the sensor's rows lie.

EXIF orientation is never applied: intrinsics belong to the sensor's orientation. EXIF positions are never read.
"""

from __future__ import annotations

import io
import math
import re
import struct
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import ExifTags, Image

from app.errors import BadPhoto, PhotoTooLarge, UnsupportedPhoto
from app.geometry.camera import CameraIdentity
from app.vision.decoding import decode_jpeg, decode_other
from app.vision.heic import decode_heic, heic_exif, heic_header
from app.vision.heic_file import is_heic
from app.vision.png_chunks import check_chunks

Pixels = npt.NDArray[np.uint8]

# MPO is a JPEG with further pictures behind the first, as some phones write it; the first one is measured.
DECODED_FORMATS = ("JPEG", "MPO", "PNG", "WEBP")
COLOUR_MODES = ("RGB", "RGBA", "P")  # a palette is expanded to colour by the decoder
# What Pillow's parsers raise on damaged bytes.
HEADER_ERRORS = (
    OSError,
    SyntaxError,
    ValueError,
    KeyError,
    IndexError,
    TypeError,
    OverflowError,
    ZeroDivisionError,
    struct.error,
)
# Fields of EXIF that complete its time, as phones write them; what looks otherwise tells nothing.
FRACTION, ZONE = re.compile(r"[0-9]{1,9}"), re.compile(r"[+-][0-9]{2}:[0-9]{2}")


@dataclass(frozen=True)
class PhotoLimits:
    """What is accepted, checked on the header before anything is decoded.

    Attributes
    ----------
    max_bytes : int
        64 MiB holds any phone's JPEG and a 12-megapixel PNG.
    max_pixels : int
        64 megapixels: 192 MB once decoded, which a worker can hold.
    """

    max_bytes: int = 64 * 2**20
    max_pixels: int = 64_000_000


@dataclass(frozen=True)
class PhotoHeader:
    """What a photograph says of itself.

    Attributes
    ----------
    width_px, height_px : int
        Size of the pixels as stored.
    format : str
        ``JPEG``, ``PNG``, ``WEBP`` or ``HEIC``.
    identity : CameraIdentity
    captured_at : str or None
        EXIF's DateTimeOriginal, with the fraction of the second and the zone where they are written:
        ``2026:02:03 04:05:06.25+01:00``; without a zone it is the phone's local time.
    has_exif : bool
        False when nothing tells which way the sensor was held.
    """

    width_px: int
    height_px: int
    format: str
    identity: CameraIdentity
    captured_at: str | None
    has_exif: bool


@dataclass(frozen=True)
class Photo:
    """Decoded pixels with their header.

    Attributes
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
        Blue, green, red; row 0 is the sensor's first row.
    header : PhotoHeader
    """

    bgr: Pixels
    header: PhotoHeader

    @property
    def identity(self) -> CameraIdentity:
        """The camera that took it."""
        return self.header.identity

    @property
    def captured_at(self) -> str | None:
        """EXIF's time as written."""
        return self.header.captured_at


def read_header(data: bytes, limits: PhotoLimits = PhotoLimits()) -> PhotoHeader:
    """Read size, format and EXIF without decoding pixels.

    Raises
    ------
    BadPhoto
        The bytes are no image, or its header is broken.
    UnsupportedPhoto
        An image of another format, or without colour.
    PhotoTooLarge
        More bytes or pixels than the limits.
    """
    if not data:
        raise BadPhoto("the photograph is empty (0 bytes): send the image file's bytes")
    if len(data) > limits.max_bytes:
        raise PhotoTooLarge(
            f"the photograph has {len(data)} bytes, the limit is {limits.max_bytes}: send it with stronger compression",
            max_bytes=limits.max_bytes,
        )
    if is_heic(data):
        size_px = heic_header(data).size_px
        _check_size(size_px, limits)
        return _header("HEIC", size_px, _readable(partial(heic_exif, data)))
    image = _open(data)
    if image.format not in DECODED_FORMATS:
        raise UnsupportedPhoto(
            f"{image.format} images are not measured: send JPEG, PNG, WebP or HEIC", format=image.format
        )
    _check_size(image.size, limits)
    if image.mode not in COLOUR_MODES:
        raise UnsupportedPhoto(
            f"pixels of type {image.mode} are not measured: targets are told by colour, send an 8-bit colour image",
            mode=image.mode,
        )
    format_name = "JPEG" if image.format == "MPO" else str(image.format)
    return _header(format_name, image.size, _readable(partial(_exif, image)))


def _check_size(size_px: tuple[int, int], limits: PhotoLimits) -> None:
    width_px, height_px = size_px
    if width_px * height_px > limits.max_pixels:
        raise PhotoTooLarge(
            f"the photograph has {width_px} x {height_px} px, the limit is {limits.max_pixels / 1e6:g} megapixels: "
            "send it at a smaller size",
            max_pixels=limits.max_pixels,
        )


def _header(format_name: str, size_px: tuple[int, int], exif: dict[int, Any]) -> PhotoHeader:
    identity = _identity(exif, *size_px)
    return PhotoHeader(*size_px, format_name, identity, _captured_at(exif), bool(exif))


def load_photo(data: bytes, limits: PhotoLimits = PhotoLimits()) -> Photo:
    """Decode a photograph, EXIF orientation not applied.

    Raises
    ------
    BadPhoto
        The bytes are no image, truncated or damaged.
    UnsupportedPhoto, PhotoTooLarge
        As ``read_header``.
    """
    header = read_header(data, limits)
    if header.format == "PNG":
        check_chunks(data)
    bgr = _pixels(data, header)
    if bgr.shape != (header.height_px, header.width_px, 3):
        raise BadPhoto(
            f"the header promises {header.width_px} x {header.height_px} px, the pixels are "
            f"{bgr.shape[1]} x {bgr.shape[0]}: copy the photograph again"
        )
    return Photo(bgr, header)


def _pixels(data: bytes, header: PhotoHeader) -> Pixels:
    match header.format:
        case "HEIC":
            return decode_heic(data)
        case "JPEG":
            return decode_jpeg(data, (header.width_px, header.height_px))
        case _:
            return decode_other(data)


def _open(data: bytes) -> Image.Image:
    try:
        with warnings.catch_warnings():
            # Pillow warns of bombs by its own limit, ours is checked on the same header; and of damaged EXIF.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            warnings.simplefilter("ignore", UserWarning)
            return Image.open(io.BytesIO(data))
    except Image.DecompressionBombError as error:
        raise PhotoTooLarge("the header promises an enormous picture: send it at a smaller size") from error
    except HEADER_ERRORS as error:
        raise BadPhoto("the bytes are no readable image: send a JPEG, PNG, WebP or HEIC file") from error


def _exif(image: Image.Image) -> dict[int, Any]:
    """EXIF tags of the picture and its camera block; empty when absent."""
    with warnings.catch_warnings():
        # Pillow warns of damaged entries that it skips: what is left of the block is still good.
        warnings.simplefilter("ignore", UserWarning)
        exif = Image.Image.getexif(image)  # a PNG's own decodes its pixels, to look behind them
        return {**dict(exif), **exif.get_ifd(ExifTags.IFD.Exif)}


def _readable(read: Callable[[], dict[int, Any]]) -> dict[int, Any]:
    """EXIF tags, or none when they are damaged: that only costs the camera's name, the pixels are still good."""
    try:
        return read()
    except HEADER_ERRORS:
        return {}


def _identity(exif: dict[int, Any], width_px: int, height_px: int) -> CameraIdentity:
    return CameraIdentity(
        make=_text(exif.get(ExifTags.Base.Make)),
        model=_text(exif.get(ExifTags.Base.Model)),
        width_px=width_px,
        height_px=height_px,
        focal_mm=_positive(exif.get(ExifTags.Base.FocalLength)),
        focal_35mm=_positive(exif.get(ExifTags.Base.FocalLengthIn35mmFilm)),
        lens=_text(exif.get(ExifTags.Base.LensModel)),
        zoom=_positive(exif.get(ExifTags.Base.DigitalZoomRatio)) or 1.0,
    )


def _captured_at(exif: dict[int, Any]) -> str | None:
    second = _text(exif.get(ExifTags.Base.DateTimeOriginal))
    fraction = FRACTION.fullmatch(_text(exif.get(ExifTags.Base.SubsecTimeOriginal)))
    zone = ZONE.fullmatch(_text(exif.get(ExifTags.Base.OffsetTimeOriginal)))
    return f"{second}{f'.{fraction[0]}' if fraction else ''}{zone[0] if zone else ''}" if second else None


def _text(value: Any) -> str:
    """Printable text of an EXIF field: trailing NULs and control characters are common in phones' files."""
    text = value.decode("ascii", "replace") if isinstance(value, bytes) else value if isinstance(value, str) else ""
    return "".join(character for character in text if character.isprintable()).strip()


def _positive(value: Any) -> float | None:
    """A positive finite number, else None: phones write 0 or 0/0 for 'unknown'."""
    try:
        number = float(value)
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    return number if math.isfinite(number) and number > 0 else None
