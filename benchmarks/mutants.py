"""Malformed images from a seed: small photographs of all formats that are read, cut, stirred and joined."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from PIL import Image

SIDE_PX = 320  # a mutant shall cost milliseconds: what breaks decoders is the file, not the number of pixels
MOST_CHANGES = 2  # at once; more give bytes that every decoder refuses at the first look
HEADER_BYTES = 1000  # where every other change falls: sizes, tables and lengths stand there
ODD_BYTES = (0x00, 0x01, 0x7F, 0x80, 0xD8, 0xD9, 0xDA, 0xFE, 0xFF)  # ends of ranges, and JPEG's marks
LONGEST_PIECE = 4096

Random = np.random.Generator
Change = Callable[[bytearray, Random], None]


def seeds(photo: bytes) -> tuple[bytes, ...]:
    """A photograph in every format, small, and as phones write it."""
    picture = Image.open(io.BytesIO(photo))
    exif = picture.info.get("exif", b"")
    small = picture.copy()
    small.thumbnail((SIDE_PX, SIDE_PX))
    palette = small.quantize(64)
    return (
        _saved(small, "JPEG", quality=90, exif=exif),
        _saved(small, "JPEG", quality=80, progressive=True),
        _saved(small, "MPO", save_all=True, append_images=[small], exif=exif),
        _saved(small, "PNG", exif=exif),
        _saved(palette, "PNG"),
        _saved(small.convert("RGBA"), "PNG"),
        _saved(small, "WEBP", quality=80, exif=exif),
        _saved(small, "WEBP", lossless=True),
        _saved(small, "WEBP", save_all=True, append_images=[small.rotate(180)]),
    )


def mutants(pictures: Sequence[bytes], seed: int, count: int) -> Iterator[bytes]:
    """So many malformed images; the same ones for the same seed."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        data = bytearray(pictures[int(random.integers(len(pictures)))])
        if random.random() < 1 / len(CHANGES):
            data = _spliced(data, pictures[int(random.integers(len(pictures)))], random)
        for _change in range(random.integers(1, MOST_CHANGES + 1)):
            CHANGES[random.integers(len(CHANGES))](data, random)
        yield bytes(data)


def _saved(picture: Image.Image, kind: str, **options: object) -> bytes:
    buffer = io.BytesIO()
    picture.save(buffer, kind, **options)
    return buffer.getvalue()


def _place(data: bytearray, random: Random) -> int:
    """Anywhere, half of the time in the header."""
    end = min(len(data), HEADER_BYTES) if random.random() < 1 / 2 else len(data)
    return int(random.integers(max(1, end)))


def _piece(data: bytearray, random: Random) -> slice:
    begin = _place(data, random)
    return slice(begin, begin + int(random.integers(1, LONGEST_PIECE)))


def _spliced(data: bytearray, other: bytes, random: Random) -> bytearray:
    """The beginning of one file, the end of another."""
    return data[: _place(data, random)] + other[_place(bytearray(other), random) :]


def _truncate(data: bytearray, random: Random) -> None:
    del data[_place(data, random) + 1 :]


def _flip_bit(data: bytearray, random: Random) -> None:
    place = _place(data, random)
    if place < len(data):
        data[place] ^= 1 << int(random.integers(8))


def _set_byte(data: bytearray, random: Random) -> None:
    place = _place(data, random)
    data[place : place + 1] = bytes([ODD_BYTES[random.integers(len(ODD_BYTES))]])


def _set_number(data: bytearray, random: Random) -> None:
    """Sizes and lengths are of two or four bytes."""
    place, width = _place(data, random), int(random.choice((2, 4)))
    data[place : place + width] = bytes([int(random.choice((0x00, 0x7F, 0xFF)))]) * width


def _remove(data: bytearray, random: Random) -> None:
    del data[_piece(data, random)]


def _repeat(data: bytearray, random: Random) -> None:
    place, piece = _place(data, random), data[_piece(data, random)]
    data[place:place] = piece * int(random.integers(1, 4))


def _insert_noise(data: bytearray, random: Random) -> None:
    place = _place(data, random)
    data[place:place] = random.bytes(int(random.integers(1, LONGEST_PIECE)))


def _blank(data: bytearray, random: Random) -> None:
    piece = _piece(data, random)
    data[piece] = bytes(len(data[piece]))


CHANGES: tuple[Change, ...] = (
    _truncate,
    _flip_bit,
    _set_byte,
    _set_number,
    _remove,
    _repeat,
    _insert_noise,
    _blank,
)
