"""Wherever a position is hidden it is gone, and nothing else of the photograph is."""

from __future__ import annotations

import io
from pathlib import Path

import cv2
import numpy as np
import piexif
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from app.errors import InvalidInput
from app.vision.photo import load_photo, read_header
from app.vision.privacy.without_position import without_position
from tests.vision.privacy import hiding
from tests.vision.privacy.hiding import Place, exif_block, jpeg_with, png_with, segment, webp_with

ROOM = Path(__file__).parents[3] / "examples" / "room"
HALL = Place(52.123456, 13.654321)
PLACES = st.builds(Place, st.floats(1.0, 89.0), st.floats(1.0, 179.0))
ICC = segment(0xE2, b"ICC_PROFILE\0\x01\x01" + b"colours at GPS latitude" * 9)  # no metadata, whatever it says


def subsets(names: list[str]) -> st.SearchStrategy[list[str]]:
    return st.lists(st.sampled_from(names), unique=True, min_size=1)


def assert_only_position_is_gone(data: bytes, place: Place) -> bytes:
    clean = without_position(data)
    for trace in place.traces:
        assert trace not in clean
    photo, before = load_photo(clean), load_photo(data)
    np.testing.assert_array_equal(photo.bgr, before.bgr)
    assert photo.header.identity == before.header.identity
    assert photo.header.captured_at == before.header.captured_at
    assert photo.header.format == before.header.format
    assert without_position(clean) == clean
    return clean


@given(
    place=PLACES,
    hidden=subsets(list(hiding.jpeg_parts(HALL))),
    trailer=st.sampled_from(list(hiding.jpeg_trailers(HALL))),
    progressive=st.booleans(),
)
def test_of_a_jpeg(place: Place, hidden: list[str], trailer: str, progressive: bool) -> None:
    first = [name for name in hidden if name in ("exif", "comment in exif", "preview")][:1]
    others = [name for name in hidden if name not in ("exif", "comment in exif", "preview")]
    parts = hiding.jpeg_parts(place)
    # A photograph has one EXIF block; without a position in it, it tells the camera that must not be forgotten.
    exif = parts[first[0]] if first else segment(0xE1, exif_block(None))
    data = jpeg_with(
        exif,
        *(parts[name] for name in others),
        ICC,
        trailer=hiding.jpeg_trailers(place)[trailer],
        progressive=progressive,
    )
    clean = assert_only_position_is_gone(data, place)
    assert piexif.load(clean)["GPS"] == {}
    assert read_header(clean).identity.model == "Phone 3"
    assert read_header(clean).captured_at == "2026:02:03 04:05:06"
    assert ICC in clean
    assert b"serial-0815" not in clean and b"the owner" not in clean


@given(place=PLACES, hidden=subsets(list(hiding.png_chunks(HALL))), second_picture=st.booleans())
def test_of_a_png(place: Place, hidden: list[str], second_picture: bool) -> None:
    chunks = hiding.png_chunks(place)
    trailer = hiding.preview(place) if second_picture else b""
    clean = assert_only_position_is_gone(png_with(*(chunks[name] for name in hidden), trailer=trailer), place)
    Image.open(io.BytesIO(clean)).verify()
    image = Image.open(io.BytesIO(clean))
    image.load()
    assert set(image.info) <= {"exif"}


@given(place=PLACES, exif=st.booleans(), xmp=st.booleans(), second_picture=st.booleans())
def test_of_a_webp(place: Place, exif: bool, xmp: bool, second_picture: bool) -> None:
    trailer = hiding.preview(place) if second_picture else b""
    data = webp_with(place, exif=exif, xmp=xmp, trailer=trailer)
    clean = assert_only_position_is_gone(data, place)
    image = Image.open(io.BytesIO(clean))
    assert image.info["icc_profile"] == b"a profile of colours"
    assert "xmp" not in image.info or not xmp
    assert (clean == data) == (not (exif or xmp or second_picture))


@given(
    parts=st.lists(st.sampled_from(list(hiding.jpeg_parts(None))), unique=True),
    trailer=st.sampled_from(list(hiding.jpeg_trailers(None))),
)
def test_a_jpeg_without_position_is_not_touched(parts: list[str], trailer: str) -> None:
    innocent = hiding.jpeg_parts(None)
    data = jpeg_with(*(innocent[name] for name in parts), ICC, trailer=hiding.jpeg_trailers(None)[trailer])
    assert without_position(data) is data


@pytest.mark.parametrize(
    "data",
    [
        png_with(*hiding.png_chunks(None).values()),
        webp_with(None, exif=True, xmp=True),
        hiding.saved("PNG"),
        hiding.saved("WEBP"),
        b"no photograph",
        b"",
    ],
    ids=["png", "webp", "bare-png", "bare-webp", "no-photograph", "empty"],
)
def test_what_holds_no_position_is_not_touched(data: bytes) -> None:
    assert without_position(data) is data


def test_photographs_of_the_room_are_not_touched() -> None:
    photos = sorted((ROOM / "locate").glob("*.jpg"))
    assert photos
    for photo in photos:
        data = photo.read_bytes()
        assert without_position(data) is data


def test_the_rewritten_block_tells_all_that_a_survey_needs() -> None:
    clean = piexif.load(without_position(jpeg_with(segment(0xE1, exif_block(HALL, note=b"anything")))))
    assert {tag: clean["0th"][tag] for tag in hiding.CAMERA} == hiding.CAMERA
    assert clean["Exif"] == hiding.EXPOSURE
    assert clean["1st"] == {} and clean["thumbnail"] is None


def test_both_byte_orders_are_read() -> None:
    little = Image.Exif()
    little.endian = "<"
    little[0x010F], little[0x0110] = "Maker", "Phone 3"
    little.get_ifd(0x8825)[2] = tuple(numerator / denominator for numerator, denominator in HALL.rationals)
    block = little.tobytes()
    data = jpeg_with(segment(0xE1, block if block.startswith(b"Exif") else b"Exif\0\0" + block))
    assert Image.open(io.BytesIO(data)).getexif().get_ifd(0x8825)
    clean = without_position(data)
    assert not Image.open(io.BytesIO(clean)).getexif().get_ifd(0x8825)
    assert read_header(clean).identity.model == "Phone 3"


def test_a_block_over_several_segments_is_one() -> None:
    block = exif_block(HALL, note=b"x" * 100).removeprefix(b"Exif\0\0")
    halves = [segment(0xE1, b"Exif\0\0" + half) for half in (block[:90], block[90:])]
    assert_only_position_is_gone(jpeg_with(*halves), HALL)


def test_a_block_that_cannot_be_read_is_not_trusted() -> None:
    damaged = bytearray(exif_block(HALL))
    damaged[10:14] = b"\xff\xff\xff\xff"  # where its first directory stands
    data = jpeg_with(segment(0xE1, bytes(damaged)))
    assert_only_position_is_gone(data, HALL)


def test_an_endless_block_ends() -> None:
    block = bytearray(exif_block(None))
    block[-4:] = block[10:14]
    without_position(jpeg_with(segment(0xE1, bytes(block))))


def test_a_text_that_unpacks_to_gigabytes_is_left_out() -> None:
    bomb = hiding.chunk(b"zTXt", b"Comment\0\0" + hiding.zlib.compress(bytes(20_000_000)))
    clean = without_position(png_with(bomb))
    assert len(clean) < len(bomb)
    np.testing.assert_array_equal(load_photo(clean).bgr[..., ::-1], hiding.pixels())


@given(
    name=st.sampled_from(["jpeg", "png", "webp"]),
    changes=st.lists(st.tuples(st.floats(0.0, 0.999), st.integers(0, 255)), min_size=1, max_size=6),
    kept=st.floats(0.1, 1.0),
)
def test_damaged_photographs_lose_no_pixel_that_could_be_read(
    name: str, changes: list[tuple[float, int]], kept: float
) -> None:
    whole = {
        "jpeg": jpeg_with(*hiding.jpeg_parts(HALL).values(), trailer=hiding.preview(HALL)),
        "png": png_with(*hiding.png_chunks(HALL).values()),
        "webp": webp_with(HALL, exif=True, xmp=True),
    }[name]
    damaged = bytearray(whole[: int(kept * len(whole))])
    for place, value in changes:
        damaged[int(place**3 * len(damaged))] = value
    data = bytes(damaged)
    clean = without_position(data)
    try:
        photo = load_photo(data)
    except InvalidInput:
        return
    np.testing.assert_array_equal(load_photo(clean).bgr, photo.bgr)


def test_pixels_are_compared_as_a_decoder_sees_them() -> None:
    decoded = cv2.imdecode(np.frombuffer(hiding.saved("PNG"), dtype=np.uint8), cv2.IMREAD_COLOR)
    assert decoded is not None
    np.testing.assert_array_equal(decoded[..., ::-1], hiding.pixels())
