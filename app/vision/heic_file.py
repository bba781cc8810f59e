"""HEIC files as boxes: which items they hold, where those lie, how the picture is turned for display.

Boxes as ISO/IEC 14496-12 has them, items and properties as ISO/IEC 23008-12. Nothing is decoded here.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

BRANDS_AT = 8
BRANDS = frozenset({b"heic", b"heix", b"heim", b"heis"})  # pictures coded with HEVC
GREATEST_ITEMS = 10_000  # a picture of 64 megapixels in tiles of 512 px has 250
FULL_BOX_BYTES = 4  # version and flags


class BadHeic(ValueError):
    """Boxes that do not hold what they promise."""


@dataclass(frozen=True)
class Box:
    """A box: its type, where it begins in the file, and where its content does."""

    kind: bytes
    at: int
    start: int
    end: int


@dataclass(frozen=True)
class Item:
    """A thing that the file holds: a picture, a block of metadata.

    Attributes
    ----------
    kind : bytes
        ``hvc1``, ``grid``, ``Exif``, ``mime`` ...
    places : tuple of (int, int)
        Where its bytes begin and end in the file.
    """

    kind: bytes
    places: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class HeicFile:
    """What a file says of its primary picture, and its items.

    Attributes
    ----------
    size_px : (int, int)
        Width and height as coded, before any turn.
    quarter_turns : int
        Anticlockwise, for display.
    mirrored, cropped : bool
        Whether it is also mirrored or cropped for display.
    items : tuple of Item
    """

    size_px: tuple[int, int]
    quarter_turns: int
    mirrored: bool
    cropped: bool
    items: tuple[Item, ...]


def is_heic(data: bytes) -> bool:
    """Whether the bytes begin as a HEIC file does."""
    if data[4:8] != b"ftyp" or len(data) < BRANDS_AT:
        return False
    brands = data[BRANDS_AT : min(len(data), int.from_bytes(data[:4], "big"))]
    return any(brands[at : at + 4] in BRANDS for at in range(0, len(brands), 4))


def read_heic(data: bytes) -> HeicFile:
    """Read a file's boxes.

    Raises
    ------
    BadHeic
    """
    try:
        meta = _only(data, 0, len(data), b"meta")
        inside = {box.kind: box for box in boxes(data, meta.start + FULL_BOX_BYTES, meta.end)}
        kinds = dict(_kinds(data, inside[b"iinf"]))
        places = dict(_places(data, inside[b"iloc"], inside.get(b"idat")))
        (primary,) = struct.unpack_from(">H", data, inside[b"pitm"].start + FULL_BOX_BYTES)
        properties = _properties(data, inside[b"iprp"], primary)
        size = next(box for box in properties if box.kind == b"ispe")
        width_px, height_px = struct.unpack_from(">II", data, size.start + FULL_BOX_BYTES)
    except (struct.error, KeyError, StopIteration, IndexError) as error:
        raise BadHeic("a box is missing or too short") from error
    turns = next((data[box.start] & 3 for box in properties if box.kind == b"irot"), 0)
    present = {box.kind for box in properties}
    items = tuple(Item(kind, places.get(number, ())) for number, kind in kinds.items())
    return HeicFile((width_px, height_px), turns, b"imir" in present, b"clap" in present, items)


def boxes(data: bytes, start: int, end: int) -> Iterator[Box]:
    """The boxes between two places.

    Raises
    ------
    BadHeic
    """
    at = start
    while at + 8 <= end:
        size, kind = struct.unpack_from(">I4s", data, at)
        header = 8
        if size == 1:
            (size,), header = struct.unpack_from(">Q", data, at + 8), 16
        elif size == 0:
            size = end - at
        if size < header or at + size > end:
            raise BadHeic("a box ends beyond what holds it")
        yield Box(kind, at, at + header, at + size)
        at += size


def _only(data: bytes, start: int, end: int, kind: bytes) -> Box:
    return next(box for box in boxes(data, start, end) if box.kind == kind)


def _kinds(data: bytes, box: Box) -> Iterator[tuple[int, bytes]]:
    """Each item's number and kind (``iinf``)."""
    version = data[box.start]
    start = box.start + FULL_BOX_BYTES + (2 if version == 0 else 4)
    for entry in boxes(data, start, box.end):
        wide = data[entry.start] >= 3
        number, _, kind = struct.unpack_from(">IH4s" if wide else ">HH4s", data, entry.start + FULL_BOX_BYTES)
        yield number, kind


def _places(data: bytes, box: Box, inline: Box | None) -> Iterator[tuple[int, tuple[tuple[int, int], ...]]]:
    """Each item's number and where its bytes lie (``iloc``), in the file or in ``idat``."""
    version = data[box.start]
    widths = struct.unpack_from(">BB", data, box.start + FULL_BOX_BYTES)
    sizes = [widths[0] >> 4, widths[0] & 15, widths[1] >> 4, widths[1] & 15 if version else 0]
    numbers = _Numbers(data, box.start + FULL_BOX_BYTES + 2, box.end)
    wide = 4 if version >= 2 else 2
    for _ in range(min(numbers.take(wide), GREATEST_ITEMS)):
        number = numbers.take(wide)
        method = numbers.take(2) & 15 if version else 0
        numbers.take(2)
        base = numbers.take(sizes[2]) + (inline.start if method == 1 and inline is not None else 0)
        found = []
        for _ in range(min(numbers.take(2), GREATEST_ITEMS)):
            numbers.take(sizes[3])
            start = base + numbers.take(sizes[0])
            found.append((start, min(len(data), start + numbers.take(sizes[1]))))
        if method <= 1:
            yield number, tuple(found)


class _Numbers:
    """Numbers of different widths, one after the other."""

    def __init__(self, data: bytes, at: int, end: int) -> None:
        self._data, self._at, self._end = data, at, end

    def take(self, width: int) -> int:
        """The next one; of no width it is zero."""
        if self._at + width > self._end:
            raise BadHeic("a list is shorter than it promises")
        self._at += width
        return int.from_bytes(self._data[self._at - width : self._at], "big")


def _properties(data: bytes, box: Box, item: int) -> list[Box]:
    """The properties of an item (``iprp``), in their order."""
    inside = {part.kind: part for part in boxes(data, box.start, box.end)}
    every = list(boxes(data, inside[b"ipco"].start, inside[b"ipco"].end))
    links = inside[b"ipma"]
    version, flags = data[links.start], int.from_bytes(data[links.start + 1 : links.start + 4], "big")
    numbers = _Numbers(data, links.start + FULL_BOX_BYTES, links.end)
    wide = 2 if flags & 1 else 1
    for _ in range(min(numbers.take(4), GREATEST_ITEMS)):
        number = numbers.take(4 if version else 2)
        linked = [numbers.take(wide) & (0x7FFF if wide == 2 else 0x7F) for _ in range(numbers.take(1))]
        if number == item:
            return [every[index - 1] for index in linked if index]
    raise BadHeic("the picture has no properties")
