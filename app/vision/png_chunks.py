"""A PNG's chunks hold what they promise: the decoder takes memory for a chunk before it looks whether there is one."""

from __future__ import annotations

import struct

from app.errors import BadPhoto

SIGNATURE_BYTES = 8
FRAME_BYTES = 12  # a chunk's length, type and checksum
LENGTH_BYTES = 4
LAST = b"IEND"


def check_chunks(data: bytes) -> None:
    """Look whether every chunk ends before the file does (PNG specification, third edition, section 5).

    Raises
    ------
    BadPhoto
        When one does not, or when the last is missing. A kilobyte could else make the decoder take 4 GB.
    """
    at = SIGNATURE_BYTES
    while at + FRAME_BYTES <= len(data):
        (size,) = struct.unpack_from(">I", data, at)
        if data[at + LENGTH_BYTES : at + LENGTH_BYTES + len(LAST)] == LAST:
            return
        at += FRAME_BYTES + size
    raise BadPhoto("the photograph is truncated or damaged and cannot be decoded: take or copy it again")
