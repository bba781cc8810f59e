"""WebP: chunks are left out or rewritten; compressed pixels stay as they are (RFC 9649)."""

from __future__ import annotations

import struct
from dataclasses import dataclass

from app.vision.privacy import signs
from app.vision.privacy.exif import HEADER
from app.vision.privacy.exif_for_survey import for_survey

SIGNATURE, SIGNATURE_AT = b"WEBP", 8
FILE_HEADER_BYTES = 12
CHUNK_HEADER_BYTES = 8
FEATURES, EXIF = b"VP8X", b"EXIF"
PICTURE = (b"VP8 ", b"VP8L", FEATURES, b"ALPH", b"ICCP", b"ANIM", b"ANMF")
XMP_FLAG, EXIF_FLAG = 0x04, 0x08  # of the features' first byte


@dataclass(frozen=True)
class Chunk:
    """A chunk: its type and its data."""

    kind: bytes
    data: bytes

    @property
    def raw(self) -> bytes:
        """As it stands in a file, padded to an even size."""
        return self.kind + struct.pack("<I", len(self.data)) + self.data + bytes(len(self.data) % 2)


def without_position(data: bytes) -> bytes:
    """The picture without position; ``data`` itself when it holds none."""
    chunks, trailer = _taken_apart(data)
    if not signs.trailer_holds_position(trailer) and not any(_holds_position(chunk) for chunk in chunks):
        return data
    block = next((for_survey(_exif_block(chunk)) for chunk in chunks if chunk.kind == EXIF), None)
    kept = [_with_flags(chunk, block is not None) for chunk in chunks if chunk.kind in PICTURE]
    if block is not None:
        kept.append(Chunk(EXIF, block))
    body = SIGNATURE + b"".join(chunk.raw for chunk in kept)
    return b"RIFF" + struct.pack("<I", len(body)) + body


def _taken_apart(data: bytes) -> tuple[list[Chunk], bytes]:
    """The picture's chunks, and what stands behind them."""
    (size,) = struct.unpack_from("<I", data, 4)
    end = min(len(data), CHUNK_HEADER_BYTES + size)
    chunks: list[Chunk] = []
    at = FILE_HEADER_BYTES
    while at + CHUNK_HEADER_BYTES <= end:
        (size,) = struct.unpack_from("<I", data, at + 4)
        start = at + CHUNK_HEADER_BYTES
        chunks.append(Chunk(data[at : at + 4], data[start : min(end, start + size)]))
        at = start + size + size % 2
    return chunks, data[min(at, end) :]


def _exif_block(chunk: Chunk) -> bytes:
    return chunk.data.removeprefix(HEADER)


def _holds_position(chunk: Chunk) -> bool:
    if chunk.kind == EXIF:
        return signs.exif_holds_position(_exif_block(chunk))
    if chunk.kind in PICTURE:
        return False
    return signs.mentions_position(chunk.data) or signs.trailer_holds_position(chunk.data)


def _with_flags(chunk: Chunk, has_exif: bool) -> Chunk:
    """Let the features say what is there."""
    if chunk.kind != FEATURES or not chunk.data:
        return chunk
    flags = chunk.data[0] & ~(XMP_FLAG | EXIF_FLAG) | (EXIF_FLAG if has_exif else 0)
    return Chunk(FEATURES, bytes([flags]) + chunk.data[1:])
