"""Pixels of a file are the same by whichever decoder, and damage is damage to both."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import BadPhoto, ScattermarkError
from app.vision.decoding import decode_jpeg, decode_other
from app.vision.photo import read_header

WIDTH, HEIGHT = 61, 43  # no whole blocks
SUBSAMPLING = {
    "4:4:4": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444,
    "4:2:2": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_422,
    "4:2:0": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420,
}


def jpeg(*options: int) -> bytes:
    colours = np.random.default_rng(1).integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8)
    return cv2.imencode(".jpg", cv2.GaussianBlur(colours, (0, 0), 2.0), options)[1].tobytes()


def outcome(data: bytes, size_px: tuple[int, int], own: bool) -> np.ndarray | None:
    try:
        return decode_jpeg(data, size_px) if own else decode_other(data)
    except BadPhoto:
        return None


@pytest.mark.parametrize("progressive", [0, 1])
@pytest.mark.parametrize("sampling", SUBSAMPLING.values(), ids=SUBSAMPLING)
def test_pixels_are_those_of_opencv(sampling: int, progressive: int) -> None:
    data = jpeg(cv2.IMWRITE_JPEG_SAMPLING_FACTOR, sampling, cv2.IMWRITE_JPEG_PROGRESSIVE, progressive)
    bgr = decode_jpeg(data, (WIDTH, HEIGHT))
    assert bgr.flags.writeable and bgr.flags.c_contiguous
    np.testing.assert_array_equal(bgr, decode_other(data))


@settings(max_examples=150, deadline=None)
@given(kept=st.floats(0.3, 1.0), changes=st.lists(st.tuples(st.floats(0.3, 0.999), st.integers(0, 255)), max_size=3))
def test_damage_is_judged_alike(kept: float, changes: list[tuple[float, int]]) -> None:
    damaged = bytearray(jpeg())
    for at, value in changes:
        damaged[int(at * len(damaged))] = value
    data = bytes(damaged[: round(kept * len(damaged))])
    try:
        header = read_header(data)
    except ScattermarkError:
        return  # nobody is asked for its pixels
    ours, theirs = (outcome(data, (header.width_px, header.height_px), own) for own in (True, False))
    assert (ours is None) == (theirs is None)
    if ours is not None:
        np.testing.assert_array_equal(ours, theirs)


def test_what_ends_too_soon_is_refused() -> None:
    with pytest.raises(BadPhoto, match="truncated or damaged"):
        decode_jpeg(jpeg()[:-40], (WIDTH, HEIGHT))
