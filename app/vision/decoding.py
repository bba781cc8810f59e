"""Pixels of a photograph's file, as the sensor's rows lie: EXIF orientation is not applied.

A JPEG is decoded by libjpeg-turbo straight into the array. OpenCV holds the same library and gives the same pixels, but
into memory of its own, from which they are copied: half as long again, and the picture twice in memory.
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt
import simplejpeg

from app.errors import BadPhoto

Pixels = npt.NDArray[np.uint8]

NO_MEMORY = -4  # OpenCV's StsNoMem
DECODE_FLAGS = cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION


def decode_jpeg(data: bytes, size_px: tuple[int, int]) -> Pixels:
    """Pixels of a JPEG, shape (H, W, 3), BGR.

    Parameters
    ----------
    size_px : tuple of int
        Width and height as its header tells.

    Raises
    ------
    BadPhoto
        It is truncated or damaged.
    """
    width_px, height_px = size_px
    room = np.empty((height_px, width_px, 3), dtype=np.uint8)
    try:
        return np.asarray(simplejpeg.decode_jpeg(data, "BGR", buffer=room), dtype=np.uint8)
    except ValueError:
        # It refuses the least damage, and kinds of JPEG that are rare: OpenCV knows which of them can be measured.
        return decode_other(data)


def decode_other(data: bytes) -> Pixels:
    """Pixels of a file in any format that OpenCV reads, shape (H, W, 3), BGR.

    Raises
    ------
    BadPhoto
        It is truncated or damaged.
    """
    try:
        bgr = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), DECODE_FLAGS)
    except cv2.error as error:
        if error.code == NO_MEMORY:
            raise MemoryError("the decoder had no memory for the pixels") from error
        raise BadPhoto("the photograph cannot be decoded: take or copy it again") from error
    if bgr is None:
        raise BadPhoto("the photograph is truncated or damaged and cannot be decoded: take or copy it again")
    return np.asarray(bgr, dtype=np.uint8)
