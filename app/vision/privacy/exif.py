"""EXIF blocks: their directories, and whether any of them points to a position.

An EXIF block is a small TIFF file (CIPA DC-008, section 4.6): a byte order, then directories of entries; an entry's
value stands in its last four bytes, or elsewhere in the block.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

HEADER = b"Exif\0\0"  # before the block in a JPEG segment, and in some WebP files
ORDERS = {b"II*\0": "<", b"MM\0*": ">"}
BLOCK_HEADER_BYTES = 8
ENTRY_BYTES = 12
INLINE_BYTES = 4
GREATEST_DIRECTORIES = 20  # a block has five; more is a loop
TYPE_BYTES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 6: 1, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8, 13: 4}

EXIF_DIRECTORY, GPS_DIRECTORY, INTEROP_DIRECTORY, SUB_DIRECTORIES = 0x8769, 0x8825, 0xA005, 0x014A
POINTERS = (EXIF_DIRECTORY, INTEROP_DIRECTORY, SUB_DIRECTORIES)


class Unreadable(Exception):
    """A block that does not hold what it promises."""


@dataclass(frozen=True)
class Entry:
    """An entry of a directory, its value in the block's byte order."""

    tag: int
    kind: int
    count: int
    value: bytes


@dataclass(frozen=True)
class Block:
    """A block that begins as one should."""

    data: bytes
    order: str

    @classmethod
    def of(cls, data: bytes) -> Block:
        """The block.

        Raises
        ------
        Unreadable
        """
        order = ORDERS.get(data[:4])
        if order is None or len(data) < BLOCK_HEADER_BYTES:
            raise Unreadable
        return cls(data, order)

    def numbers(self, layout: str, at: int) -> tuple[int, ...]:
        """Numbers that stand in the block."""
        try:
            return struct.unpack_from(self.order + layout, self.data, at)
        except struct.error as error:
            raise Unreadable from error

    @property
    def first(self) -> int:
        """Where the picture's directory begins."""
        return self.numbers("I", 4)[0]

    def directory(self, at: int) -> tuple[tuple[Entry, ...], int]:
        """The entries of a directory, and where the next one begins (0: nowhere)."""
        (count,) = self.numbers("H", at)
        end = at + 2 + count * ENTRY_BYTES
        (following,) = self.numbers("I", end) if end + INLINE_BYTES <= len(self.data) else (0,)
        entries = (self._entry(at + 2 + index * ENTRY_BYTES) for index in range(count))
        return tuple(entry for entry in entries if entry is not None), following

    def _entry(self, at: int) -> Entry | None:
        """The entry; None when its value is not in the block, which costs this entry alone."""
        tag, kind, count = self.numbers("HHI", at)
        size = TYPE_BYTES.get(kind, 0) * count
        start = at + ENTRY_BYTES - INLINE_BYTES if size <= INLINE_BYTES else self.numbers("I", at + 8)[0]
        value = self.data[start : start + size]
        # A pointer says where something begins even when its type is wrong.
        if tag == GPS_DIRECTORY or (size and len(value) == size):
            return Entry(tag, kind, count, value)
        return None

    def pointers(self, entry: Entry) -> tuple[int, ...]:
        """Where the directories begin that an entry names."""
        if entry.tag not in POINTERS or TYPE_BYTES.get(entry.kind) != INLINE_BYTES:
            return ()
        return struct.unpack(f"{self.order}{entry.count}I", entry.value)


def holds_position(data: bytes) -> bool:
    """Whether any directory of a block points to a position; also when it cannot be read to its end."""
    try:
        return any(entry.tag == GPS_DIRECTORY for entry in _all_entries(Block.of(data)))
    except Unreadable:
        return True


def _all_entries(block: Block) -> Iterator[Entry]:
    """Entries of all directories; only the picture's chain goes on, elsewhere cameras write garbage."""
    waiting, seen = [(block.first, True)], {0}
    while waiting:
        at, chained = waiting.pop()
        if at in seen:
            continue
        seen.add(at)
        if len(seen) > GREATEST_DIRECTORIES:
            raise Unreadable
        entries, following = block.directory(at)
        yield from entries
        waiting += [(place, False) for entry in entries for place in block.pointers(entry)]
        if chained:
            waiting.append((following, True))
