"""An EXIF block with what a survey needs, and nothing else of the block that it is taken from."""

from __future__ import annotations

import struct

from app.vision.privacy.exif import (
    BLOCK_HEADER_BYTES,
    ENTRY_BYTES,
    EXIF_DIRECTORY,
    INLINE_BYTES,
    Block,
    Entry,
    Unreadable,
)

LONG = 4  # the type of an offset
GREATEST_VALUE_BYTES = 1000  # names of cameras and lenses are shorter, and 60 of these fit into a JPEG's segment
# Make, model, orientation, resolution (3), software, time, chroma siting.
KEPT_OF_PICTURE = frozenset({0x010F, 0x0110, 0x0112, 0x011A, 0x011B, 0x0128, 0x0131, 0x0132, 0x0213})
KEPT_OF_CAMERA = frozenset(
    {
        *(0x829A, 0x829D, 0x8822, 0x8827, 0x8830, 0x8832),  # exposure time, aperture, programme, sensitivity
        *(0x9000, 0x9003, 0x9004, 0x9010, 0x9011, 0x9012, 0x9290, 0x9291, 0x9292),  # version, times and their zones
        *(0x9101, 0x9102, 0xA000, 0xA001, 0xA002, 0xA003),  # components, compression, colour space, size
        *range(0x9201, 0x920B),  # shutter ... focal length
        *(0xA20E, 0xA20F, 0xA210, 0xA217, 0xA300, 0xA301),  # pitch of the sensor, its kind
        *range(0xA401, 0xA40B),  # rendering, exposure mode, white balance, digital zoom, focal length in 35 mm ...
        *(0xA432, 0xA433, 0xA434),  # lens
    }
)


def for_survey(data: bytes) -> bytes | None:
    """The block with camera, lens, exposure, orientation and times alone; None when none of them can be read."""
    try:
        block = Block.of(data)
        entries, _ = block.directory(block.first)
    except Unreadable:
        return None
    picture = _kept(entries, KEPT_OF_PICTURE)
    camera = _kept(_camera_entries(block, entries), KEPT_OF_CAMERA)
    if not picture and not camera:
        return None
    return _written(block, picture, camera)


def _camera_entries(block: Block, entries: tuple[Entry, ...]) -> tuple[Entry, ...]:
    for entry in entries:
        if entry.tag == EXIF_DIRECTORY:
            try:
                return block.directory(block.pointers(entry)[0])[0]
            except (Unreadable, IndexError):
                return ()
    return ()


def _kept(entries: tuple[Entry, ...], tags: frozenset[int]) -> list[Entry]:
    """The first entry of each wanted tag, in the order that the standard asks for."""
    wanted = [entry for entry in entries if entry.tag in tags and len(entry.value) <= GREATEST_VALUE_BYTES]
    first = {entry.tag: entry for entry in reversed(wanted)}
    return [first[tag] for tag in sorted(first)]


def _written(block: Block, picture: list[Entry], camera: list[Entry]) -> bytes:
    pointer_at = BLOCK_HEADER_BYTES + _directory_bytes(picture, 1)
    if camera:
        place = struct.pack(f"{block.order}I", pointer_at)
        picture = [*picture, Entry(EXIF_DIRECTORY, LONG, 1, place)]
    head = block.data[:4] + struct.pack(f"{block.order}I", BLOCK_HEADER_BYTES)
    body = _directory(block.order, picture, BLOCK_HEADER_BYTES)
    return head + body + (_directory(block.order, camera, pointer_at) if camera else b"")


def _directory_bytes(entries: list[Entry], more: int) -> int:
    """Size of a directory with its values, and ``more`` entries whose values fit into them."""
    values = sum(_padded(len(entry.value)) for entry in entries if len(entry.value) > INLINE_BYTES)
    return 2 + ENTRY_BYTES * (len(entries) + more) + INLINE_BYTES + values


def _directory(order: str, entries: list[Entry], at: int) -> bytes:
    table, values = struct.pack(f"{order}H", len(entries)), b""
    values_at = at + 2 + ENTRY_BYTES * len(entries) + INLINE_BYTES
    for entry in entries:
        table += struct.pack(f"{order}HHI", entry.tag, entry.kind, entry.count)
        if len(entry.value) <= INLINE_BYTES:
            table += entry.value.ljust(INLINE_BYTES, b"\0")
        else:
            table += struct.pack(f"{order}I", values_at + len(values))
            values += entry.value.ljust(_padded(len(entry.value)), b"\0")
    return table + bytes(INLINE_BYTES) + values


def _padded(size: int) -> int:
    """Values begin at even places."""
    return size + size % 2
