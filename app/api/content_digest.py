"""The digest that a client announces for what it sends, so that bytes that changed on the way are noticed."""

from __future__ import annotations

import base64
import binascii
import re
from typing import Annotated

from fastapi import Header, Query

from app.errors import InvalidInput

SHA256_BYTES = 32
# RFC 9530: a dictionary of algorithms, each digest as base64 between colons (RFC 9651).
MEMBER = re.compile(r"\s*([a-z*][a-z0-9_.*-]*)=:([A-Za-z0-9+/=]*):\s*")
Sha256 = Annotated[
    str | None, Query(pattern="^[0-9a-fA-F]{64}$", description="SHA-256 of the body; other bytes are refused.")
]
ContentDigest = Annotated[
    str | None, Header(description="Digests of the body as RFC 9530 has them: sha-256=:...:", max_length=1000)
]


def announced_sha256(sha256: Sha256 = None, content_digest: ContentDigest = None) -> str | None:
    """SHA-256 that was announced, as hexadecimal digits; None when none was.

    Raises
    ------
    InvalidInput
        For a header that is none, and when header and query differ.
    """
    found = None if content_digest is None else _of_header(content_digest)
    wanted = None if sha256 is None else sha256.lower()
    if found is not None and wanted is not None and found != wanted:
        raise InvalidInput("Content-Digest and sha256 announce different bytes; send one of them", field="sha256")
    return found or wanted


def _of_header(text: str) -> str | None:
    """Of a header's algorithms only SHA-256 is looked at: the others are answered by none of the store's digests."""
    for part in text.split(","):
        member = MEMBER.fullmatch(part)
        if member is None:
            raise _unreadable(text)
        if member[1] == "sha-256":
            return _hexadecimal(member[2], text)
    return None


def _hexadecimal(encoded: str, text: str) -> str:
    try:
        digest = base64.b64decode(encoded, validate=True)
    except binascii.Error as error:
        raise _unreadable(text) from error
    if len(digest) != SHA256_BYTES:
        raise _unreadable(text)
    return digest.hex()


def _unreadable(text: str) -> InvalidInput:
    return InvalidInput(
        f"Content-Digest: {text[:100]!r} is no digest as RFC 9530 has it; send sha-256=:<base64 of the 32 bytes>:",
        field="Content-Digest",
    )
