"""Pictures made to hurt whoever opens them: small files of much work, files that are two things, headers that lie."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from functools import cache

import numpy as np
from PIL import Image

from tests.faults.ledger import SNAPSHOT_BYTES

HTML = b"<!doctype html><script>alert(document.domain)</script>"
EXIF_HEADER = b"Exif\0\0"


def segment(marker: int, data: bytes) -> bytes:
    """A JPEG segment."""
    return struct.pack(">BBH", 0xFF, marker, len(data) + 2) + data


def with_segment(marker: int, data: bytes) -> bytes:
    """The snapshot with one more segment, first of all."""
    return SNAPSHOT_BYTES[:2] + segment(marker, data) + SNAPSHOT_BYTES[2:]


def png_chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width_px: int, height_px: int, *chunks: bytes, pixels: bytes = b"") -> bytes:
    """A PNG of colour with further chunks before its pixels, which are rows of zeros unless others are given."""
    header = png_chunk(b"IHDR", struct.pack(">IIBBBBB", width_px, height_px, 8, 2, 0, 0, 0))
    rows = pixels or zlib.compress(bytes((1 + 3 * width_px) * height_px), 9)
    return b"\x89PNG\r\n\x1a\n" + header + b"".join(chunks) + png_chunk(b"IDAT", rows) + png_chunk(b"IEND", b"")


def zipped(name: str, data: bytes) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, data)
    return buffer.getvalue()


def saved(image: Image.Image, kind: str, **options: object) -> bytes:
    buffer = io.BytesIO()
    image.save(buffer, kind, **options)
    return buffer.getvalue()


def multi_picture() -> bytes:
    """The snapshot as phones write it with a second picture behind the first."""
    first = Image.open(io.BytesIO(SNAPSHOT_BYTES))
    return saved(
        first, "MPO", save_all=True, append_images=[Image.new("RGB", (64, 48))], quality=95, exif=first.info["exif"]
    )


@cache
def endless_scans(scans: int) -> bytes:
    """A progressive JPEG of 16 megapixels whose last scan stands there again and again: 50 kB for minutes of work."""
    data = saved(Image.new("RGB", (4000, 4000), (90, 100, 110)), "JPEG", progressive=True, quality=30)
    last = data.rindex(b"\xff\xda")
    return data[:last] + data[last:-2] * scans + data[-2:]


def exif_that_points_to_itself() -> bytes:
    """A directory whose entry is the same directory."""
    entry = struct.pack("<HHII", 0x8769, 4, 1, 8)
    directory = struct.pack("<H", 1) + entry + struct.pack("<I", 8)
    return with_segment(0xE1, EXIF_HEADER + b"II*\0" + struct.pack("<I", 8) + directory)


def exif_of_many_values() -> bytes:
    """An entry that promises four thousand million values."""
    entry = struct.pack("<HHII", 0x010F, 2, 2**32 - 1, 26)
    directory = struct.pack("<H", 1) + entry + struct.pack("<I", 0)
    return with_segment(0xE1, EXIF_HEADER + b"II*\0" + struct.pack("<I", 8) + directory)


def jpeg_of_size(width_px: int, height_px: int) -> bytes:
    """The snapshot with another size in its header."""
    frame = SNAPSHOT_BYTES.index(b"\xff\xc0")
    size = struct.pack(">HH", height_px, width_px)
    return SNAPSHOT_BYTES[: frame + 5] + size + SNAPSHOT_BYTES[frame + 9 :]


def webp_of_size(width_px: int, height_px: int) -> bytes:
    """A WebP of a few bytes whose extended header promises a canvas of any size."""
    canvas = struct.pack("<I", 0) + (width_px - 1).to_bytes(3, "little") + (height_px - 1).to_bytes(3, "little")
    body = b"WEBPVP8X" + struct.pack("<I", len(canvas)) + canvas
    small = saved(Image.new("RGB", (16, 16)), "WEBP", lossless=True)
    body += small[12:]
    return b"RIFF" + struct.pack("<I", len(body)) + body


LOCATED = {
    "a zip behind the picture": SNAPSHOT_BYTES + zipped("payload.html", HTML),
    "a page behind the picture": SNAPSHOT_BYTES + HTML,
    "a page in a comment": with_segment(0xFE, HTML),
    "a PNG behind the picture": SNAPSHOT_BYTES + png(8, 8),
    "zeros behind the picture": SNAPSHOT_BYTES + bytes(100_000),
    "itself behind itself": SNAPSHOT_BYTES * 2,
    "two pictures in one file": multi_picture(),
    "comments without end": with_segment(0xFE, bytes(60_000)) + b"",
}

# name: bytes, statuses of which one says what is wrong
REFUSED: dict[str, tuple[bytes, set[int]]] = {
    "a GIF named JPEG": (saved(Image.new("RGB", (64, 48)), "GIF"), {415}),
    "a zip before the picture": (zipped("a.txt", b"x") + SNAPSHOT_BYTES, {415}),
    "a page before the picture": (HTML + SNAPSHOT_BYTES, {415}),
    "SVG": (b'<svg xmlns="http://www.w3.org/2000/svg" onload="alert(1)"/>', {415}),
    "gzip of a picture": (b"\x1f\x8b\x08\0\0\0\0\0\0\3" + zlib.compress(SNAPSHOT_BYTES)[2:-4], {415}),
    "a huge JPEG of few bytes": (jpeg_of_size(65_500, 65_500), {413}),
    "a taller JPEG than it is": (jpeg_of_size(1280, 4000), {415, 422}),
    "a huge WebP of few bytes": (webp_of_size(16_000, 16_000), {413, 415}),
    "a canvas larger than its picture": (webp_of_size(4000, 4000), {415, 422}),
    "a flat PNG of 30 megapixels": (png(6000, 5000), {422}),
    "pixels without end": (png(64, 48, pixels=zlib.compress(bytes(50_000_000), 9)), {415, 422}),
    "pixels of no picture": (png(64, 48, pixels=b"not zlib at all"), {415}),
    "a profile without end": (png(64, 48, png_chunk(b"iCCP", b"x\0\0" + zlib.compress(bytes(50_000_000)))), {415, 422}),
    "a text without end": (png(64, 48, png_chunk(b"zTXt", b"x\0\0" + zlib.compress(bytes(50_000_000)))), {415, 422}),
    "chunks of no length": (png(64, 48, *[png_chunk(b"tEXt", b"")] * 5_000), {415, 422}),
    "a chunk of all lengths": (png(64, 48)[:33] + b"\xff\xff\xff\xffIDAT" + bytes(1000), {415}),
    "no rows": (png(64, 0), {415}),
    "an animation": (
        saved(Image.new("RGB", (64, 48)), "WEBP", save_all=True, append_images=[Image.new("RGB", (64, 48), "red")] * 5),
        {415, 422},
    ),
    "EXIF that points to itself": (exif_that_points_to_itself(), {200, 422}),
    "EXIF of many values": (exif_of_many_values(), {200, 422}),
}


def truncated(seed: int, count: int) -> list[bytes]:
    """The snapshot cut anywhere."""
    cuts = np.random.default_rng(seed).integers(1, len(SNAPSHOT_BYTES), count)
    return [SNAPSHOT_BYTES[:cut] for cut in sorted(int(cut) for cut in cuts)]
