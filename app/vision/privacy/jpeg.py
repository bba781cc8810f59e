"""JPEG: segments are left out or rewritten; tables and compressed pixels stay as they are, byte by byte.

Segments as ITU-T T.81, annex B, has them; what applications put into theirs as their own documents say.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from app.vision.privacy import signs
from app.vision.privacy.exif import HEADER
from app.vision.privacy.exif_for_survey import for_survey

SIGNATURE = b"\xff\xd8\xff"
START, END, SCAN, COMMENT = 0xD8, 0xD9, 0xDA, 0xFE
APPLICATION = range(0xE0, 0xF0)
DENSITY, EXIF_OR_XMP, CAPTION = 0xE0, 0xE1, 0xED
STANDALONE = (0x01, *range(0xD0, 0xD9))
LENGTH_BYTES = 2
# What the pixels' meaning hangs on: density, colour profile, colour transform. A decoder reads these and no others.
NEEDED = {DENSITY: b"JFIF\0", 0xE2: b"ICC_PROFILE\0", 0xEE: b"Adobe"}
MARKER = re.compile(rb"\xff[^\x00\xff]")
MARKER_BEHIND_SCAN = re.compile(rb"\xff[^\x00\xff\xd0-\xd7]")  # zeros and restarts belong to the scan


@dataclass(frozen=True)
class Segment:
    """A marker with what belongs to it: ``raw`` as it stands in the file, ``body`` without marker and length."""

    marker: int
    raw: bytes
    body: bytes

    @property
    def is_exif(self) -> bool:
        """Whether it carries an EXIF block, or a further part of a long one."""
        return self.marker == EXIF_OR_XMP and self.body.startswith(HEADER)

    @property
    def is_metadata(self) -> bool:
        """Whether pixels mean the same without it."""
        described = self.marker == COMMENT or self.marker in APPLICATION
        needed = NEEDED.get(self.marker)
        return described and (needed is None or not self.body.startswith(needed))


def without_position(data: bytes) -> bytes:
    """The picture without position; ``data`` itself when it holds none."""
    segments, trailer = _taken_apart(data)
    if not _holds_position(segments, trailer):
        return data
    block = for_survey(_exif_block(segments))
    kept = [segment for segment in segments if not segment.is_metadata]
    head = 1 + sum(segment.marker == DENSITY for segment in kept[:2])  # the picture's start, and JFIF where it is used
    return b"".join([*(segment.raw for segment in kept[:head]), _exif_segment(block), *(s.raw for s in kept[head:])])


def _taken_apart(data: bytes) -> tuple[list[Segment], bytes]:
    """The first picture's segments, and what stands behind it."""
    segments: list[Segment] = []
    at = 0
    for segment, end in _segments(data):
        segments.append(segment)
        at = end
    return segments, data[at:]


def _segments(data: bytes) -> Iterator[tuple[Segment, int]]:
    """Each segment and where it ends, until the picture ends. Decoders pass over what stands between; so does this."""
    at = 0
    while (found := MARKER.search(data, at)) is not None:
        marker, start = found[0][1], found.start()
        at = found.end() if marker in (*STANDALONE, END) else _end_of_segment(data, marker, found.end())
        yield Segment(marker, data[start:at], data[found.end() + LENGTH_BYTES : at]), at
        if marker == END:
            return


def _end_of_segment(data: bytes, marker: int, at: int) -> int:
    end = min(len(data), at + max(LENGTH_BYTES, int.from_bytes(data[at : at + LENGTH_BYTES], "big")))
    if marker != SCAN:
        return end
    following = MARKER_BEHIND_SCAN.search(data, end)
    return len(data) if following is None else following.start()


def _holds_position(segments: list[Segment], trailer: bytes) -> bool:
    if signs.trailer_holds_position(trailer):
        return True
    if any(segment.is_exif for segment in segments) and signs.exif_holds_position(_exif_block(segments)):
        return True
    others = [segment for segment in segments if segment.is_metadata and not segment.is_exif]
    return any(_mentions_position(segment) for segment in others)


def _mentions_position(segment: Segment) -> bool:
    if segment.marker == CAPTION and signs.names_a_place(segment.body):
        return True
    return signs.mentions_position(segment.body) or signs.trailer_holds_position(segment.body)


def _exif_block(segments: list[Segment]) -> bytes:
    """The EXIF block, put together from its segments: a long one has several."""
    return b"".join(segment.body[len(HEADER) :] for segment in segments if segment.is_exif)


def _exif_segment(block: bytes | None) -> bytes:
    if block is None:
        return b""
    body = HEADER + block
    return bytes([0xFF, EXIF_OR_XMP]) + (len(body) + LENGTH_BYTES).to_bytes(LENGTH_BYTES, "big") + body
