"""HEIC photographs, as phones take them: pixels as the sensor's rows lie, decoded by libheif where it is installed.

libheif turns pictures for display. That is undone here: intrinsics belong to the sensor's orientation.
"""

from __future__ import annotations

import importlib.util
import io
import warnings
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import ExifTags, Image

from app.errors import BadPhoto, UnsupportedPhoto
from app.vision.heic_file import BadHeic, HeicFile, read_heic
from app.vision.privacy.heic import exif_blocks

# What libheif's binding raises on damaged bytes.
DECODE_ERRORS = (ValueError, EOFError, SyntaxError, RuntimeError, OSError)
DAMAGED = "the HEIC photograph is truncated or damaged and cannot be decoded: take or copy it again"


def heic_header(data: bytes) -> HeicFile:
    """Size and items, nothing decoded.

    Raises
    ------
    UnsupportedPhoto
        When libheif is not installed, or the picture is cropped or mirrored for display.
    BadPhoto
    """
    if importlib.util.find_spec("pi_heif") is None:
        raise UnsupportedPhoto(
            "this server reads no HEIC: send JPEG, PNG or WebP, or install scattermark[heic] on it", format="HEIC"
        )
    try:
        file = read_heic(data)
    except BadHeic as error:
        raise BadPhoto(DAMAGED) from error
    if file.mirrored or file.cropped:
        raise UnsupportedPhoto("the photograph was mirrored or cropped: send it as it was taken", format="HEIC")
    return file


def heic_exif(data: bytes) -> dict[int, Any]:
    """EXIF tags of the picture and its camera block; empty when there are none."""
    for block in exif_blocks(data):
        exif = Image.Exif()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of damaged entries that are skipped
            exif.load(b"Exif\0\0" + block)
            return {**dict(exif), **exif.get_ifd(ExifTags.IFD.Exif)}
    return {}


def decode_heic(data: bytes) -> npt.NDArray[np.uint8]:
    """Blue, green, red of shape (H, W, 3), row 0 the sensor's first row.

    Raises
    ------
    BadPhoto, UnsupportedPhoto
    """
    import pi_heif

    file = heic_header(data)
    try:
        decoded = pi_heif.open_heif(io.BytesIO(data), convert_hdr_to_8bit=True, bgr_mode=True)
        mode, shown = decoded.mode, np.array(decoded)  # a copy: the decoder's memory goes with it
    except DECODE_ERRORS as error:
        raise BadPhoto(DAMAGED) from error
    if not mode.startswith("BGR"):
        raise UnsupportedPhoto(f"pixels of type {mode} are not measured: send an 8-bit colour image", mode=mode)
    return np.ascontiguousarray(np.rot90(shown[..., :3], -file.quarter_turns))
