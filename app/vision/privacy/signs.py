"""Signs of a position in text and in blocks whose meaning is not known."""

from __future__ import annotations

import re

from app.vision.privacy import exif

# Of metadata: properties of XMP and of captions that programs write. A sign too many costs metadata, never pixels.
WORDS = re.compile(
    rb"GPS[\w:= -]|latitude|longitude|\b(?:lat|lon|lng)\s*[=:]|geo(?:tag|:|location)|ISO6709|Location|Sublocation"
    rb"|photoshop:(?:City|State|Country)|CountryCode|CountryName|ProvinceState|Iptc4xmp",
    re.IGNORECASE,
)
# Of IPTC-IIM, record 2: content location (26, 27), city, sublocation, province, country (90, 92, 95, 100, 101).
CAPTION_PLACES = re.compile(rb"\x1c\x02[\x1a\x1b\x5a\x5c\x5f\x64\x65]")
# Of films and pictures behind a picture, megabytes long: only what chance does not write, as QuickTime's and 3GPP's.
FILM_PLACES = re.compile(rb"\xa9xyz|loci\0\0\0\0|ISO6709|GPSL(?:at|ong)itude|:Location")


def mentions_position(metadata: bytes) -> bool:
    """Whether a block of metadata speaks of a place, in one byte or two per letter."""
    return WORDS.search(metadata.replace(b"\0", b"")) is not None


def names_a_place(caption: bytes) -> bool:
    """Whether a caption of a press agency's kind (IPTC-IIM) names a place."""
    return CAPTION_PLACES.search(caption) is not None or mentions_position(caption)


def exif_holds_position(block: bytes) -> bool:
    """Whether an EXIF block holds a position, mentions one, or cannot be read far enough to tell."""
    return exif.holds_position(block) or mentions_position(block) or _nested_blocks_hold_position(block)


def trailer_holds_position(trailer: bytes) -> bool:
    """Whether what stands behind a picture holds a position: another picture, a film."""
    return _nested_blocks_hold_position(trailer) or FILM_PLACES.search(trailer) is not None


def _nested_blocks_hold_position(data: bytes) -> bool:
    """Of pictures within: previews, second pictures."""
    return any(exif.holds_position(block) for block in data.split(exif.HEADER)[1:])
