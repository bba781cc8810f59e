"""HEIC as a phone takes it: the sensor's rows whichever way it was held, no position, no surprise from damaged boxes.

The two files of ``heic/`` show one scene of 128 x 96 px, red in its first rows and blue in its last; ``turned`` is
shown upright as 96 x 128 px and has a position in EXIF and XMP, ``plain`` has neither. pillow-heif wrote them.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import BadPhoto, InvalidInput, PhotoTooLarge, UnsupportedPhoto
from app.vision.heic_file import BadHeic, is_heic, read_heic
from app.vision.photo import PhotoLimits, load_photo, read_header
from app.vision.privacy.without_position import without_position
from tests.vision.privacy.hiding import saved

FOLDER = Path(__file__).parent / "heic"
TURNED, PLAIN = ((FOLDER / f"{name}.heic").read_bytes() for name in ("turned", "plain"))
RED, BLUE = (20, 20, 250), (250, 20, 20)  # blue, green, red
LOSS = 12  # grey values, of the strongest compression that a phone uses


@pytest.mark.parametrize("data", [TURNED, PLAIN], ids=["turned", "plain"])
def test_the_first_row_is_the_sensors(data: bytes) -> None:
    photo = load_photo(data)
    assert photo.bgr.shape == (96, 128, 3)
    for rows, columns, colour in ((slice(4, 12), slice(4, 20), RED), (slice(80, 92), slice(108, 124), BLUE)):
        found = photo.bgr[rows, columns].reshape(-1, 3).mean(axis=0)
        assert np.abs(found - colour).max() < LOSS
    assert (photo.header.format, photo.identity.make, photo.identity.model) == ("HEIC", "Apple", "iPhone 15")
    assert (photo.header.width_px, photo.header.height_px) == (128, 96)
    assert photo.captured_at == "2026:02:03 04:05:06"


def test_decoding_twice_gives_the_same_pixels() -> None:
    np.testing.assert_array_equal(load_photo(PLAIN).bgr, load_photo(PLAIN).bgr)


def test_a_position_is_written_over() -> None:
    assert read_heic(TURNED).quarter_turns == 3
    assert b"GPSLatitude" in TURNED
    clean = without_position(TURNED)
    assert len(clean) == len(TURNED)
    assert not any(trace in clean for trace in (b"GPS", b"52.5", b"maker's note", (1234567).to_bytes(4, "big")))
    np.testing.assert_array_equal(load_photo(clean).bgr, load_photo(TURNED).bgr)
    assert read_header(clean) == read_header(TURNED)
    assert without_position(clean) is clean


def test_a_film_beside_the_picture_is_written_over() -> None:
    film = (32).to_bytes(4, "big") + b"moov" + b"\0\0\0\x18udta\xa9xyz+52.5+013.4/"[:24]
    clean = without_position(PLAIN + film)
    assert b"+52.5" not in clean
    np.testing.assert_array_equal(load_photo(clean).bgr, load_photo(PLAIN).bgr)


def test_what_holds_no_position_is_not_touched() -> None:
    assert without_position(PLAIN) is PLAIN


def test_limits_are_those_of_other_photographs() -> None:
    with pytest.raises(PhotoTooLarge, match="128 x 96 px"):
        read_header(PLAIN, PhotoLimits(max_pixels=128 * 96 - 1))


def test_without_libheif_the_advice_is_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _name: None)
    with pytest.raises(UnsupportedPhoto, match=r"scattermark\[heic\]"):
        read_header(PLAIN)


@pytest.mark.parametrize("kept", [0.01, 0.02, 0.1, 0.5, 0.9])
def test_truncated_photographs_are_refused(kept: float) -> None:
    with pytest.raises(BadPhoto):
        load_photo(PLAIN[: int(kept * len(PLAIN))])


def test_a_size_that_is_not_that_of_the_pixels_is_refused() -> None:
    size = (128).to_bytes(4, "big") + (96).to_bytes(4, "big")
    assert PLAIN.count(size) == 1
    with pytest.raises(BadPhoto):
        load_photo(PLAIN.replace(size, (64).to_bytes(4, "big") + (48).to_bytes(4, "big")))


def test_other_formats_are_none() -> None:
    assert not any(
        is_heic(data) for data in (b"", b"ftyp", saved("JPEG"), saved("PNG"), b"\0\0\0\x14ftypmp42\0\0\0\0mp42")
    )


@given(
    changes=st.lists(st.tuples(st.floats(0.0, 0.999), st.integers(0, 255)), min_size=1, max_size=8),
    kept=st.floats(0.0, 1.0),
)
def test_damaged_boxes_give_a_header_or_an_error_of_ours(changes: list[tuple[float, int]], kept: float) -> None:
    damaged = bytearray(TURNED[: int(kept * len(TURNED))])
    for place, value in changes:
        if damaged:
            damaged[int(place**2 * len(damaged))] = value
    data = bytes(damaged)
    if is_heic(data):
        assert len(without_position(data)) == len(data)
    try:
        header = read_header(data)
    except InvalidInput:
        return
    assert header.width_px * header.height_px <= PhotoLimits().max_pixels


def test_no_file_is_an_endless_one() -> None:
    with pytest.raises(BadHeic):
        read_heic(b"\0\0\0\x08ftyp" + b"\0\0\0\x00meta" + bytes(4))
