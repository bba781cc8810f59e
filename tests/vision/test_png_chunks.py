"""A PNG is looked through before it is decoded."""

from __future__ import annotations

import resource

import numpy as np
import pytest
from PIL.PngImagePlugin import PngImageFile

from app.errors import BadPhoto
from app.vision.photo import load_photo, read_header
from app.vision.png_chunks import check_chunks
from tests.api.bad_photos import encoded, png_that_promises

PICTURE = np.random.default_rng(1).integers(0, 255, (48, 64, 3), dtype=np.uint8)
PNG = encoded(PICTURE, "PNG")
PIXELS_AT = PNG.index(b"IDAT") - 4
MOST_KB = 256 * 1024


def test_a_whole_picture_passes_with_whatever_stands_behind_it() -> None:
    check_chunks(PNG)
    check_chunks(PNG + b"more")
    np.testing.assert_array_equal(load_photo(PNG + b"more").bgr[..., ::-1], PICTURE)


@pytest.mark.parametrize("end", range(8, len(PNG) - 12, 977))
def test_a_cut_picture_does_not(end: int) -> None:
    with pytest.raises(BadPhoto):
        check_chunks(PNG[:end])


@pytest.mark.parametrize("size", [b"\xff\xff\xff\xff", b"\x7f\xff\xff\xff", b"\x10\x00\x00\x00"])
def test_a_chunk_longer_than_its_file_takes_no_memory(size: bytes) -> None:
    before_kb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(BadPhoto, match="truncated or damaged"):
        load_photo(PNG[:PIXELS_AT] + size + PNG[PIXELS_AT + 4 :])
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb < MOST_KB


def test_a_header_is_read_without_the_pixels(monkeypatch: pytest.MonkeyPatch) -> None:
    """A picture of 40 megapixels in a few bytes would else be decoded by whoever wants to know its size."""

    def decode(_image: PngImageFile) -> None:
        raise AssertionError("pixels are decoded")

    monkeypatch.setattr(PngImageFile, "load", decode)
    assert read_header(png_that_promises(8000, 5000)).width_px == 8000
