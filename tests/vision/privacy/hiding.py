"""Photographs that hold a position wherever phones and programs put one, and innocent ones with the same metadata."""

from __future__ import annotations

import io
import struct
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
import piexif
from PIL import Image

WIDTH, HEIGHT = 48, 32
CAMERA = {piexif.ImageIFD.Make: b"Maker", piexif.ImageIFD.Model: b"Phone 3", piexif.ImageIFD.Orientation: 6}
EXPOSURE = {
    piexif.ExifIFD.DateTimeOriginal: b"2026:02:03 04:05:06",
    piexif.ExifIFD.FocalLength: (425, 100),
    piexif.ExifIFD.FocalLengthIn35mmFilm: 26,
    piexif.ExifIFD.DigitalZoomRatio: (2, 1),
    piexif.ExifIFD.LensModel: b"main lens",
}
XMP, LONG_XMP = b"http://ns.adobe.com/xap/1.0/\0", b"http://ns.adobe.com/xmp/extension/\0"
CAPTION = b"Photoshop 3.0\x008BIM\x04\x04\0\0"


@dataclass(frozen=True)
class Place:
    """A position, and how it reads in each way of writing it down."""

    latitude_deg: float
    longitude_deg: float

    @property
    def text(self) -> bytes:
        return f"{self.latitude_deg:.6f},{self.longitude_deg:.6f}".encode()

    @property
    def rationals(self) -> tuple[tuple[int, int], ...]:
        micro = int(abs(self.latitude_deg) * 1e6)
        return ((micro, 1_000_001), (17, 1_000_003), (23, 1_000_007))

    @property
    def traces(self) -> tuple[bytes, ...]:
        """Bytes of which none may be left, in both byte orders."""
        numbers = [number for pair in self.rationals for number in pair]
        wide = self.text.decode().encode("utf-16-be")
        return self.text, wide, *(struct.pack(f"{order}6I", *numbers) for order in "<>")

    @property
    def directory(self) -> dict[int, Any]:
        return {
            piexif.GPSIFD.GPSLatitudeRef: b"N",
            piexif.GPSIFD.GPSLatitude: self.rationals,
            piexif.GPSIFD.GPSDateStamp: b"2026:02:03",
        }

    @property
    def xmp(self) -> bytes:
        return b"<x:xmpmeta><rdf:Description exif:GPSLatitude='" + self.text + b"'/></x:xmpmeta>"


def pixels() -> np.ndarray:
    return np.random.default_rng(5).integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8)


def saved(format_name: str, **options: Any) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(pixels()).save(buffer, format_name, **options)
    return buffer.getvalue()


def exif_block(place: Place | None, note: bytes = b"", preview: bytes = b"") -> bytes:
    """An EXIF block with its header; of another byte order than Pillow's."""
    tables: dict[str, Any] = {"0th": dict(CAMERA), "Exif": dict(EXPOSURE), "GPS": {}, "1st": {}, "thumbnail": None}
    if place is not None:
        tables["GPS"] = place.directory
    if note:
        tables["Exif"][piexif.ExifIFD.UserComment] = b"ASCII\0\0\0" + note
        tables["Exif"][piexif.ExifIFD.MakerNote] = note
        tables["Exif"][piexif.ExifIFD.BodySerialNumber] = b"serial-0815"
        tables["0th"][piexif.ImageIFD.Artist] = b"the owner"
    if preview:
        tables["1st"] = {piexif.ImageIFD.Compression: 6}
        tables["thumbnail"] = preview
    return bytes(piexif.dump(tables))


def segment(marker: int, body: bytes) -> bytes:
    return bytes([0xFF, marker]) + struct.pack(">H", len(body) + 2) + body


def jpeg_with(*parts: bytes, trailer: bytes = b"", **options: Any) -> bytes:
    """A JPEG with further segments behind its first one, and something behind its end."""
    data = saved("JPEG", quality=90, **options)
    at = 4 + struct.unpack(">H", data[4:6])[0]
    return data[:at] + b"".join(parts) + data[at:] + trailer


def preview(place: Place | None) -> bytes:
    """A small picture with metadata of its own."""
    return bytes(jpeg_with(segment(0xE1, exif_block(place))))


def jpeg_parts(place: Place | None) -> dict[str, bytes]:
    """Segments by what they are; with a place each of them holds it."""
    text = b"in the hall" if place is None else b"GPS: " + place.text
    xmp = b"<x:xmpmeta dc:format='image/jpeg'/>" if place is None else place.xmp
    town = b"" if place is None else b"\x1c\x02\x5a" + struct.pack(">H", len(place.text)) + place.text
    return {
        "exif": segment(0xE1, exif_block(place)),
        "comment in exif": segment(0xE1, exif_block(None, note=text)),
        "preview": segment(0xE1, exif_block(None, preview=preview(place))),
        "xmp": segment(0xE1, XMP + xmp),
        "long xmp": segment(0xE1, LONG_XMP + b"0" * 40 + xmp),
        "xmp in two bytes": segment(0xE1, XMP + xmp.decode().encode("utf-16-be")),
        "caption": segment(0xED, CAPTION + b"\x1c\x02\x19\0\3abc" + town),
        "comment": segment(0xFE, text),
        "maker's": segment(0xE7, b"MAKER\0" + text),
    }


def jpeg_trailers(place: Place | None) -> dict[str, bytes]:
    coordinates = b"" if place is None else b"\0\0\0\x20\xa9xyz\0\x12\x15\xc7" + place.text
    return {
        "nothing": b"",
        "second picture": preview(place),
        "film": b"\0\0\0\x18ftypmp42" + coordinates + bytes(1000),
    }


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png_chunks(place: Place | None) -> dict[str, bytes]:
    text = b"in the hall" if place is None else b"GPS: " + place.text
    xmp = b"<x:xmpmeta/>" if place is None else place.xmp
    block = exif_block(place)
    profile = b"Raw profile type exif\0\0" + zlib.compress(b"\nexif\n%8d\n%s\n" % (len(block), block.hex().encode()))
    return {
        "exif": chunk(b"eXIf", block.removeprefix(b"Exif\0\0")),
        "text": chunk(b"tEXt", b"Comment\0" + text),
        "packed text": chunk(b"zTXt", b"Comment\0\0" + zlib.compress(text)),
        "xmp": chunk(b"iTXt", b"XML:com.adobe.xmp\0\0\0\0\0" + xmp),
        "packed xmp": chunk(b"iTXt", b"XML:com.adobe.xmp\0\1\0\0\0" + zlib.compress(xmp)),
        "profile": chunk(b"zTXt", profile),
    }


def png_with(*chunks: bytes, trailer: bytes = b"") -> bytes:
    data = saved("PNG")
    at = 8 + 12 + 13
    return data[:at] + b"".join(chunks) + data[at:] + trailer


def webp_with(place: Place | None, *, exif: bool, xmp: bool, trailer: bytes = b"") -> bytes:
    options: dict[str, Any] = {}
    if exif:
        options["exif"] = exif_block(place)
    if xmp:
        options["xmp"] = b"<x:xmpmeta/>" if place is None else place.xmp
    return saved("WEBP", lossless=True, icc_profile=b"a profile of colours", **options) + trailer
