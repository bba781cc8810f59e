"""Entity tags (RFC 9110, 8.8.3): whoever has an answer already is told so in place of getting it again."""

from __future__ import annotations

KEPT = {"Cache-Control": "private, no-cache"}  # kept by the browser, asked for each time: keys may be revoked


def headers_of(tag: str) -> dict[str, str]:
    """Headers of an answer that is known by a tag."""
    return {"ETag": f'"{tag}"', **KEPT}


def holds(if_none_match: str, tag: str) -> bool:
    """Whether the client has the answer with this tag already."""
    held = [part.strip().removeprefix("W/") for part in if_none_match.split(",")]
    return "*" in held or f'"{tag}"' in held
