"""HEIC: metadata is written over in its place, to the byte as long as it was; nothing moves, pixels stay."""

from __future__ import annotations

from collections.abc import Iterator

from app.vision.heic_file import BadHeic, Box, boxes, read_heic
from app.vision.privacy import signs
from app.vision.privacy.exif import HEADER
from app.vision.privacy.exif_for_survey import for_survey

OFFSET_BYTES = 4  # before the block of an Exif item: how far behind them it begins
METADATA = (b"mime", b"uri ")  # XMP and the like
PICTURE = (b"ftyp", b"meta", b"mdat")  # boxes; what stands beside them is no part of the picture
SPARE = b"free"  # a box that nobody reads

Place = tuple[int, int]


def without_position(data: bytes) -> bytes:
    """The picture without position; ``data`` itself when it holds none."""
    try:
        items = read_heic(data).items
        others = [box for box in boxes(data, 0, len(data)) if box.kind not in PICTURE]
    except BadHeic:
        return data  # no decoder reads it, and nobody takes it
    exifs = [place for item in items if item.kind == b"Exif" for place in item.places]
    texts = [place for item in items if item.kind in METADATA for place in item.places]
    held = (
        any(signs.exif_holds_position(_block(data[start:end])) for start, end in exifs)
        or any(signs.mentions_position(data[start:end]) for start, end in texts)
        or any(signs.trailer_holds_position(data[box.start : box.end]) for box in others)
    )
    return _written_over(data, exifs, texts, others) if held else data


def exif_blocks(data: bytes) -> Iterator[bytes]:
    """The EXIF blocks of a file's items."""
    try:
        items = read_heic(data).items
    except BadHeic:
        return
    for item in items:
        if item.kind == b"Exif":
            yield from (_block(data[start:end]) for start, end in item.places)


def _written_over(data: bytes, exifs: list[Place], texts: list[Place], others: list[Box]) -> bytes:
    written = bytearray(data)
    for start, end in exifs:
        block = for_survey(_block(data[start:end])) or b""
        content = bytes(OFFSET_BYTES) + block
        written[start:end] = content[: end - start].ljust(end - start, b"\0")
    for start, end in [*texts, *((box.start, box.end) for box in others)]:
        written[start:end] = bytes(end - start)
    for box in others:
        written[box.at + 4 : box.at + 8] = SPARE
    return bytes(written)


def _block(item: bytes) -> bytes:
    """The EXIF block of an item."""
    start = OFFSET_BYTES + int.from_bytes(item[:OFFSET_BYTES], "big")
    return item[start:].removeprefix(HEADER) if start <= len(item) else item[OFFSET_BYTES:].removeprefix(HEADER)
