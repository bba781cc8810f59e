"""Times of photographs, as their files tell them."""

from dataclasses import replace

import numpy as np
import pytest

from app.cli.located_trajectory import exif_seconds
from app.errors import InvalidInput
from app.geometry.camera import CameraIdentity
from app.planning.imaging import ImagingOptions
from app.planning.photo_file import encode_jpeg
from app.vision.photo import read_header

NOON_S = 1_767_268_800.0  # 2026-01-01T12:00:00Z


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("2026:01:01 12:00:00", NOON_S),
        ("2026:01:01 12:00:00.25", NOON_S + 0.25),
        ("2026:01:01 12:00:00.0625", NOON_S + 0.0625),
        ("2026:01:01 13:30:00.5+01:30", NOON_S + 0.5),
        ("2026:01:01 07:00:00-05:00", NOON_S),
    ],
)
def test_a_time_of_exif_has_its_fraction_and_its_zone(text: str, seconds: float) -> None:
    assert exif_seconds("a.jpg", text) == seconds


@pytest.mark.parametrize("text", [None, "", "0000:00:00 00:00:00", "2026:13:01 12:00:00", "yesterday", "2026:01:01"])
def test_what_is_no_time_is_named(text: str | None) -> None:
    with pytest.raises(InvalidInput, match=r"a\.jpg does not tell when it was taken"):
        exif_seconds("a.jpg", text)


def test_what_a_simulated_walk_writes_is_what_is_read() -> None:
    identity = CameraIdentity("Maker", "Model", 32, 24)
    imaging = replace(ImagingOptions(), captured_at="2026:01:01 12:00:00.375")
    header = read_header(encode_jpeg(np.zeros((24, 32, 3), np.uint8), imaging, identity))
    assert exif_seconds("walk.jpg", header.captured_at) == NOON_S + 0.375
