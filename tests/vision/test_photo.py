import io
import struct
import zlib

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import ExifTags, Image

from app.errors import BadPhoto, InvalidInput, PhotoTooLarge, UnsupportedPhoto
from app.vision.photo import PhotoLimits, load_photo, read_header

WIDTH, HEIGHT = 60, 40
EXIF_START = b"Exif\x00\x00"


def picture() -> np.ndarray:
    """Smooth colours, shape (40, 60, 3), blue, green, red, no two corners alike."""
    row, column = np.mgrid[0:HEIGHT, 0:WIDTH]
    return np.stack([4 * column, 6 * row, 255 - 2 * row - 2 * column], axis=-1).astype(np.uint8)


def encoded(extension: str, *parameters: int) -> bytes:
    return cv2.imencode(extension, picture(), list(parameters))[1].tobytes()


JPEG, PNG = encoded(".jpg", cv2.IMWRITE_JPEG_QUALITY, 95), encoded(".png")
PROGRESSIVE = encoded(".jpg", cv2.IMWRITE_JPEG_PROGRESSIVE, 1)
LOSSLESS_WEBP = encoded(".webp", cv2.IMWRITE_WEBP_QUALITY, 101)


def saved(mode: str, file_format: str, **options: object) -> bytes:
    """The picture in one of Pillow's modes and formats."""
    buffer = io.BytesIO()
    Image.fromarray(picture()[..., ::-1].copy()).convert(mode).save(buffer, file_format, **options)
    return buffer.getvalue()


def with_exif(fill: dict[int, object], camera_block: dict[int, object]) -> bytes:
    exif = Image.Exif()
    exif.update(fill)
    exif.get_ifd(ExifTags.IFD.Exif).update(camera_block)
    return saved("RGB", "JPEG", quality=95, exif=exif.tobytes())


PHONE = with_exif(
    {ExifTags.Base.Make: "Maker", ExifTags.Base.Model: "Phone 3\x00\x00", ExifTags.Base.Orientation: 6},
    {
        ExifTags.Base.DateTimeOriginal: "2026:02:03 04:05:06",
        ExifTags.Base.FocalLength: 4.25,
        ExifTags.Base.FocalLengthIn35mmFilm: 26,
        ExifTags.Base.DigitalZoomRatio: 2.0,
        ExifTags.Base.LensModel: "main lens",
    },
)


def png_header(width: int, height: int) -> bytes:
    """A PNG that promises a size and holds next to nothing."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")


@pytest.mark.parametrize(("data", "name"), [(PNG, "PNG"), (LOSSLESS_WEBP, "WEBP")], ids=["png", "webp"])
def test_lossless_pixels_arrive_as_they_were(data: bytes, name: str) -> None:
    photo = load_photo(data)
    np.testing.assert_array_equal(photo.bgr, picture())
    assert (photo.header.format, photo.header.width_px, photo.header.height_px) == (name, WIDTH, HEIGHT)
    assert (photo.identity.width_px, photo.identity.height_px) == (WIDTH, HEIGHT)


@pytest.mark.parametrize(
    "data", [JPEG, PROGRESSIVE, saved("RGB", "JPEG", quality=95)], ids=["baseline", "progressive", "pillow"]
)
def test_jpeg_is_read_in_blue_green_red(data: bytes) -> None:
    photo = load_photo(data)
    assert photo.header.format == "JPEG"
    assert np.abs(photo.bgr.astype(int) - picture()).mean() < 3.0  # quality 95 rounds by a few grey values


@pytest.mark.parametrize(
    "data", [JPEG, PROGRESSIVE, PNG, LOSSLESS_WEBP], ids=["baseline", "progressive", "png", "webp"]
)
@pytest.mark.parametrize("kept", [0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99])
def test_truncated_photographs_are_refused(data: bytes, kept: float) -> None:
    with pytest.raises(BadPhoto):
        load_photo(data[: int(kept * len(data))])


def test_a_photograph_that_lacks_its_last_pixels_is_refused() -> None:
    for missing in range(3, 20):  # a JPEG ends with a marker of two bytes
        with pytest.raises(BadPhoto):
            load_photo(JPEG[:-missing])


@pytest.mark.parametrize(
    "data",
    [b"", b"\xff", b"not an image", b"%PDF-1.7 " + bytes(500), bytes(1000)],
    ids=["empty", "a-byte", "text", "pdf", "zeros"],
)
def test_what_is_no_image_is_refused(data: bytes) -> None:
    with pytest.raises(BadPhoto) as raised:
        load_photo(data)
    assert ":" in raised.value.detail  # what happened: what to do


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (saved("L", "JPEG"), "L"),
        (saved("L", "PNG"), "L"),
        (saved("LA", "PNG"), "LA"),
        (saved("1", "PNG"), "1"),
        (saved("I;16", "PNG"), "I;16"),
        (saved("CMYK", "JPEG"), "CMYK"),
        (saved("RGB", "TIFF"), "TIFF"),
        (saved("RGB", "BMP"), "BMP"),
        (saved("RGB", "GIF"), "GIF"),
    ],
    ids=["grey-jpeg", "grey-png", "grey-alpha", "one-bit", "16-bit-grey", "cmyk", "tiff", "bmp", "gif"],
)
def test_other_pixels_and_formats_are_refused_by_name(data: bytes, kind: str) -> None:
    with pytest.raises(UnsupportedPhoto, match=kind):
        load_photo(data)


def test_colours_of_sixteen_bits_keep_their_upper_eight() -> None:
    lower = np.random.default_rng(1).integers(0, 256, picture().shape).astype(np.uint16)
    data = cv2.imencode(".png", picture().astype(np.uint16) * 256 + lower)[1].tobytes()
    # Libraries halve the depth by dropping the lower byte or by rounding.
    assert np.abs(load_photo(data).bgr.astype(int) - picture()).max() <= 1


@pytest.mark.parametrize("mode", ["P", "RGBA"])
def test_palettes_and_transparency_become_plain_colour(mode: str) -> None:
    photo = load_photo(saved(mode, "PNG"))
    assert photo.bgr.shape == (HEIGHT, WIDTH, 3)
    assert np.abs(photo.bgr.astype(int) - picture()).mean() < (30 if mode == "P" else 1e-9)  # a palette is coarse


def test_one_pixel_is_a_photograph() -> None:
    data = cv2.imencode(".png", np.array([[[10, 20, 30]]], dtype=np.uint8))[1].tobytes()
    assert load_photo(data).bgr.tolist() == [[[10, 20, 30]]]


def test_the_camera_is_named_and_the_picture_not_turned() -> None:
    photo = load_photo(PHONE)
    assert photo.bgr.shape == (HEIGHT, WIDTH, 3)  # orientation 6 would swap the sides
    assert np.abs(photo.bgr.astype(int) - picture()).mean() < 3.0
    identity = photo.identity
    assert (identity.make, identity.model, identity.lens) == ("Maker", "Phone 3", "main lens")
    assert (identity.focal_mm, identity.focal_35mm, identity.zoom) == (pytest.approx(4.25), 26.0, 2.0)
    assert (identity.width_px, identity.height_px) == (WIDTH, HEIGHT)
    assert photo.captured_at == "2026:02:03 04:05:06"
    assert photo.header.has_exif


@pytest.mark.parametrize(
    ("fraction", "zone", "told"),
    [
        ("25", "+01:00", "2026:02:03 04:05:06.25+01:00"),
        ("0625\0", "   :  ", "2026:02:03 04:05:06.0625"),
        ("  ", "-03:30", "2026:02:03 04:05:06-03:30"),
        ("soon", "Z", "2026:02:03 04:05:06"),
    ],
)
def test_a_time_has_the_fraction_and_the_zone_that_are_written(fraction: str, zone: str, told: str) -> None:
    time = {
        ExifTags.Base.DateTimeOriginal: "2026:02:03 04:05:06",
        ExifTags.Base.SubsecTimeOriginal: fraction,
        ExifTags.Base.OffsetTimeOriginal: zone,
    }
    assert read_header(with_exif({}, time)).captured_at == told


def test_zero_and_undefined_focal_lengths_are_unknown() -> None:
    undefined = with_exif({}, {ExifTags.Base.FocalLength: (0, 0), ExifTags.Base.FocalLengthIn35mmFilm: 0})
    identity = read_header(undefined).identity
    assert (identity.focal_mm, identity.focal_35mm, identity.zoom) == (None, None, 1.0)


def test_a_file_without_exif_says_so() -> None:
    header = read_header(JPEG)
    assert not header.has_exif and header.captured_at is None
    assert (header.identity.make, header.identity.model, header.identity.focal_35mm) == ("", "", None)


def test_damaged_exif_costs_only_the_name() -> None:
    at = PHONE.index(EXIF_START) + len(EXIF_START)
    junk = [b"\x00" * 8, b"MM\x00\x2a\xff\xff\xff\xff", b"II\x2a\x00\x08\x00\x00\x00\xff\xff\xff\xff\xff"]
    for bytes_ in junk:
        damaged = PHONE[:at] + bytes_ + PHONE[at + len(bytes_) :]
        photo = load_photo(damaged)
        np.testing.assert_array_equal(photo.bgr, load_photo(PHONE).bgr)
        assert photo.captured_at is None and not photo.header.has_exif


@pytest.mark.parametrize("size", [(60_000, 60_000), (9_000, 9_000)])  # beyond and within what Pillow itself opens
def test_a_bomb_is_refused_by_its_header(monkeypatch: pytest.MonkeyPatch, size: tuple[int, int]) -> None:
    def decode(*_: object) -> None:
        raise AssertionError("pixels were decoded")

    monkeypatch.setattr(cv2, "imdecode", decode)
    with pytest.raises(PhotoTooLarge):
        load_photo(png_header(*size))


def test_limits_are_exact() -> None:
    assert load_photo(PNG, PhotoLimits(len(PNG), WIDTH * HEIGHT)).bgr.shape == (HEIGHT, WIDTH, 3)
    with pytest.raises(PhotoTooLarge) as raised:
        load_photo(PNG, PhotoLimits(max_bytes=len(PNG) - 1))
    assert raised.value.fields == {"max_bytes": len(PNG) - 1}
    with pytest.raises(PhotoTooLarge) as raised:
        load_photo(PNG, PhotoLimits(max_pixels=WIDTH * HEIGHT - 1))
    assert raised.value.fields == {"max_pixels": WIDTH * HEIGHT - 1}


def test_pixels_that_differ_from_their_header_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cv2, "imdecode", lambda *_: np.zeros((WIDTH, HEIGHT, 3), dtype=np.uint8))  # sides swapped
    with pytest.raises(BadPhoto, match="header promises 60 x 40 px"):
        load_photo(PNG)


def test_of_several_pictures_in_a_file_the_first_is_measured() -> None:
    second = Image.new("RGB", (WIDTH, HEIGHT), (9, 9, 9))
    photo = load_photo(saved("RGB", "MPO", quality=95, save_all=True, append_images=[second]))
    assert photo.header.format == "JPEG"
    assert np.abs(photo.bgr.astype(int) - picture()).mean() < 3.0


@settings(max_examples=100, deadline=None)
@given(
    name=st.sampled_from(["phone", "png", "webp"]),
    changes=st.lists(st.tuples(st.floats(0.0, 0.999), st.integers(0, 255)), min_size=1, max_size=6),
)
def test_damaged_bytes_give_a_photograph_or_an_error_of_ours(name: str, changes: list[tuple[float, int]]) -> None:
    damaged = bytearray({"phone": PHONE, "png": PNG, "webp": LOSSLESS_WEBP}[name])
    for place, value in changes:
        # Most of what can go wrong stands in the first bytes.
        damaged[int(place**3 * len(damaged))] = value
    try:
        photo = load_photo(bytes(damaged), PhotoLimits(max_pixels=1_000_000))
    except InvalidInput:
        return
    assert photo.bgr.shape == (photo.header.height_px, photo.header.width_px, 3)
