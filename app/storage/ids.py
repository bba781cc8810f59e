"""Ids that sort by the time they were made."""

from __future__ import annotations

import secrets
import time
import uuid

RANDOM_BITS_A, RANDOM_BITS_B = 12, 62


def new_id() -> str:
    """A UUID of version 7 as text.

    Notes
    -----
    RFC 9562, section 5.7: 48 bits of Unix time in ms, the version, 12 random bits, the variant, 62 random bits.
    """
    milliseconds = time.time_ns() // 1_000_000
    high = (milliseconds & (2**48 - 1)) << 16 | 0x7 << 12 | secrets.randbits(RANDOM_BITS_A)
    low = 0b10 << 62 | secrets.randbits(RANDOM_BITS_B)
    return str(uuid.UUID(int=high << 64 | low))
