"""A photograph for people's eyes: smaller, turned upright, without anything that its metadata tells.

What is measured is never turned: intrinsics belong to the sensor's orientation (``app.vision.photo``).
"""

from __future__ import annotations

import io
import warnings
from dataclasses import dataclass

import numpy as np
from PIL import ExifTags, Image

from app.errors import BadPhoto
from app.vision.photo import HEADER_ERRORS, PhotoLimits, load_photo, read_header

FORMAT_WITH_DRAFT = "JPEG"  # decoded at an eighth, a quarter or half of its size by the decoder itself
QUARTER_TURN_DEG = 90
# EXIF's orientation (CIPA DC-008, 4.6.4 A) as quarter turns clockwise that show the picture upright. Mirrored
# orientations are written by no camera; they are shown as they lie.
QUARTER_TURNS = {1: 0, 6: 1, 3: 2, 8: 3}


@dataclass(frozen=True)
class DisplayOptions:
    """How a photograph is shown.

    Attributes
    ----------
    width_px : int
        Greatest width before it is turned; none is enlarged.
    upright : bool
        Turned as EXIF says, or as the sensor's rows lie, which is where dots were measured.
    quality : int
        Of the JPEG: at 85 no eye tells it from the original on a screen.
    """

    width_px: int
    upright: bool = True
    quality: int = 85


def quarter_turns(data: bytes) -> int:
    """Quarter turns clockwise that show a photograph upright; 0 when nothing tells, and for HEIC.

    Raises
    ------
    BadPhoto
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Pillow warns of damaged entries that it skips
        try:
            with Image.open(io.BytesIO(data)) as image:
                return QUARTER_TURNS.get(image.getexif().get(ExifTags.Base.Orientation, 1), 0)
        except HEADER_ERRORS:
            return 0  # pixels are good without their metadata, and HEIC is none of Pillow's


def display_jpeg(data: bytes, options: DisplayOptions, limits: PhotoLimits) -> bytes:
    """A photograph as a JPEG to look at.

    Raises
    ------
    BadPhoto, UnsupportedPhoto, PhotoTooLarge
    """
    image = _decoded(data, options.width_px, limits)
    height_px = max(1, round(image.height * options.width_px / image.width))
    if image.width > options.width_px:
        image = image.resize((options.width_px, height_px), Image.Resampling.BOX)
    turns = quarter_turns(data) if options.upright else 0
    # Pillow turns anticlockwise.
    shown = image.rotate(-QUARTER_TURN_DEG * turns, expand=True) if turns else image
    written = io.BytesIO()
    shown.save(written, "JPEG", quality=options.quality)
    return written.getvalue()


def _decoded(data: bytes, width_px: int, limits: PhotoLimits) -> Image.Image:
    """Pixels as the sensor's rows lie, of about the wanted width where the decoder can do that."""
    header = read_header(data, limits)
    if header.format != FORMAT_WITH_DRAFT:
        return Image.fromarray(np.ascontiguousarray(load_photo(data, limits).bgr[..., ::-1]))
    try:
        image = Image.open(io.BytesIO(data))
        image.draft("RGB", (width_px, max(1, width_px * header.height_px // header.width_px)))
        return image.convert("RGB")
    except HEADER_ERRORS as error:
        raise BadPhoto("the photograph is truncated or damaged and cannot be shown: take or copy it again") from error
