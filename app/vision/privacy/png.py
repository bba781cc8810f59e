"""PNG: chunks are left out or rewritten; compressed pixels stay as they are.

Chunks as the PNG specification (third edition) has them; text profiles as ImageMagick writes them.
"""

from __future__ import annotations

import re
import struct
import zlib
from dataclasses import dataclass

from app.vision.privacy import signs
from app.vision.privacy.exif import HEADER
from app.vision.privacy.exif_for_survey import for_survey

SIGNATURE = b"\x89PNG\r\n\x1a\n"
FRAME_BYTES = 12  # a chunk's length, type and checksum
EXIF, PIXELS, END = b"eXIf", b"IDAT", b"IEND"
PICTURE = (b"IHDR", b"PLTE", PIXELS, END)
# What the pixels' meaning hangs on: transparency and colour.
MEANING = (b"tRNS", b"gAMA", b"cHRM", b"sRGB", b"iCCP", b"sBIT", b"cICP", b"mDCV", b"cLLI", b"bKGD", b"pHYs")
TEXTS = (b"tEXt", b"zTXt", b"iTXt")
GREATEST_TEXT_BYTES = 4 * 2**20  # of a text once unpacked; a longer one is not looked at but left out
PROFILE = re.compile(rb"Raw profile type (\w+)\0.*?\n\s*\w+\n\s*\d+\n([0-9a-fA-F\s]*)", re.DOTALL)


@dataclass(frozen=True)
class Chunk:
    """A chunk: its type and its data."""

    kind: bytes
    data: bytes

    @property
    def raw(self) -> bytes:
        """As it stands in a file."""
        checksum = zlib.crc32(self.kind + self.data)
        return struct.pack(">I", len(self.data)) + self.kind + self.data + struct.pack(">I", checksum)

    @property
    def is_metadata(self) -> bool:
        """Whether pixels mean the same without it."""
        return self.kind not in PICTURE and self.kind not in MEANING


def without_position(data: bytes) -> bytes:
    """The picture without position; ``data`` itself when it holds none."""
    chunks, trailer = _taken_apart(data)
    if not signs.trailer_holds_position(trailer) and not any(_holds_position(chunk) for chunk in chunks):
        return data
    block = next((kept for chunk in chunks if (kept := _for_survey(chunk)) is not None), None)
    written = [SIGNATURE]
    for chunk in chunks:
        if chunk.kind == PIXELS and block is not None:  # EXIF stands before the pixels
            written.append(Chunk(EXIF, block).raw)
            block = None
        if not chunk.is_metadata:
            written.append(chunk.raw)
    return b"".join(written)


def _taken_apart(data: bytes) -> tuple[list[Chunk], bytes]:
    """The picture's chunks, and what stands behind them or is none."""
    chunks: list[Chunk] = []
    at = len(SIGNATURE)
    while at + FRAME_BYTES <= len(data) and not (chunks and chunks[-1].kind == END):
        (size,) = struct.unpack_from(">I", data, at)
        if at + FRAME_BYTES + size > len(data):
            break
        chunks.append(Chunk(data[at + 4 : at + 8], data[at + 8 : at + 8 + size]))
        at += FRAME_BYTES + size
    return chunks, data[at:]


def _holds_position(chunk: Chunk) -> bool:
    if chunk.kind == EXIF:
        return signs.exif_holds_position(chunk.data)
    if not chunk.is_metadata:
        return False
    text = _text(chunk)
    if text is None or signs.mentions_position(text):
        return True
    profile = _profile(text)
    if profile is None:
        return signs.trailer_holds_position(text)
    kind, body = profile
    if kind in (b"exif", b"APP1") and body.startswith(HEADER):
        return signs.exif_holds_position(body.removeprefix(HEADER))
    return signs.names_a_place(body)


def _for_survey(chunk: Chunk) -> bytes | None:
    """The EXIF block of a chunk that has one, without what a survey does not need."""
    if chunk.kind == EXIF:
        return for_survey(chunk.data)
    profile = _profile(_text(chunk) or b"") if chunk.kind in TEXTS else None
    return None if profile is None else for_survey(profile[1].removeprefix(HEADER))


def _text(chunk: Chunk) -> bytes | None:
    """A chunk's keyword and text, unpacked; None when it cannot be. A chunk that is no text is taken as it is."""
    keyword, _, rest = chunk.data.partition(b"\0")
    if chunk.kind == b"zTXt":
        return _unpacked(keyword, rest[1:])
    if chunk.kind == b"iTXt" and rest[:1] == b"\1":
        return _unpacked(keyword, rest[2:].split(b"\0", 2)[-1])
    return chunk.data


def _unpacked(keyword: bytes, packed: bytes) -> bytes | None:
    unpacker = zlib.decompressobj()
    try:
        text = unpacker.decompress(packed, GREATEST_TEXT_BYTES)
    except zlib.error:
        return None
    return keyword + b"\0" + text if unpacker.eof else None


def _profile(text: bytes) -> tuple[bytes, bytes] | None:
    """Kind and bytes of a profile that is written as hexadecimal text; None when the text is none."""
    found = PROFILE.match(text)
    if found is None:
        return None
    digits = b"".join(found[2].split())
    return found[1], bytes.fromhex(digits[: len(digits) // 2 * 2].decode("ascii"))
