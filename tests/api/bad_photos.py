"""Images that no survey and no snapshot can use."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
from PIL import Image

from tests.api.serving import room_photos

GOOD = room_photos("locate")["IMG_0000.jpg"]


def encoded(pixels: np.ndarray, kind: str, **options: object) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, kind, **options)
    return buffer.getvalue()


def png_that_promises(width_px: int, height_px: int) -> bytes:
    """A PNG of a few bytes whose header promises a picture of any size."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width_px, height_px, 8, 2, 0, 0, 0)
    pixels = zlib.compress(b"\0" * 10_000)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b"")


def cmyk() -> bytes:
    buffer = io.BytesIO()
    Image.new("CMYK", (64, 48), (10, 200, 30, 40)).save(buffer, "JPEG")
    return buffer.getvalue()


COLOUR = np.random.default_rng(1).integers(0, 255, (48, 64, 3), dtype=np.uint8)

# name: bytes, statuses that say what is wrong
BAD_PHOTOS: dict[str, tuple[bytes, int]] = {
    "empty": (b"", 415),
    "text": (b"this is no photograph at all", 415),
    "zeros": (bytes(10_000), 415),
    "html": (b"<!doctype html><script>alert(1)</script>", 415),
    "pdf": (b"%PDF-1.7\n1 0 obj\n<<>>\nendobj\n", 415),
    "half a header": (GOOD[:20], 415),
    "gif": (encoded(COLOUR, "GIF"), 415),
    "tiff": (encoded(COLOUR, "TIFF"), 415),
    "bmp": (encoded(COLOUR, "BMP"), 415),
    "grey": (encoded(COLOUR[..., 0], "JPEG"), 415),
    "16 bit": (encoded(COLOUR[..., 0].astype(np.uint16) * 257, "PNG"), 415),
    "cmyk": (cmyk(), 415),
    "bomb": (png_that_promises(60_000, 60_000), 413),
    "enormous bomb": (png_that_promises(2**31 - 1, 2**31 - 1), 413),
}

# Headers that are right, pixels that are not: seen when they are decoded.
DAMAGED_PHOTOS: dict[str, bytes] = {
    "truncated jpeg": GOOD[: len(GOOD) // 10],
    "truncated png": encoded(COLOUR, "PNG")[:200],
    "promises more than it holds": png_that_promises(500, 400),
}
