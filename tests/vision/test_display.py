"""Pictures for people's eyes: as wide as wanted, upright, without metadata."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import ExifTags, Image

from app.errors import BadPhoto
from app.vision.display import DisplayOptions, display_jpeg, quarter_turns
from app.vision.photo import PhotoLimits

LIMITS = PhotoLimits()
WIDTH_PX, HEIGHT_PX = 320, 160
LEVEL_TOLERANCE = 12  # of 255: what JPEG at quality 85 changes in an even area


def photograph(kind: str = "JPEG", orientation: int | None = None) -> bytes:
    """Red in the upper left quarter, grey elsewhere."""
    rgb = np.full((HEIGHT_PX, WIDTH_PX, 3), 128, np.uint8)
    rgb[: HEIGHT_PX // 2, : WIDTH_PX // 2] = (200, 20, 20)
    exif = Image.Exif()
    if orientation is not None:
        exif[ExifTags.Base.Orientation] = orientation
    written = io.BytesIO()
    Image.fromarray(rgb).save(written, kind, exif=exif, quality=95)
    return written.getvalue()


def shown(data: bytes, **options: object) -> Image.Image:
    return Image.open(io.BytesIO(display_jpeg(data, DisplayOptions(**options), LIMITS)))  # type: ignore[arg-type]


def quarter_of_red(image: Image.Image) -> tuple[bool, bool]:
    """Whether red lies right, and whether it lies below."""
    red = np.asarray(image.convert("RGB")).astype(int) @ (1, -1, 0) > 100
    rows, columns = np.nonzero(red)
    assert len(rows) == pytest.approx(red.size / 4, rel=0.1)
    return bool(columns.mean() > red.shape[1] / 2), bool(rows.mean() > red.shape[0] / 2)


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "WEBP"])
def test_a_picture_is_as_wide_as_wanted_and_never_enlarged(kind: str) -> None:
    assert shown(photograph(kind), width_px=80).size == (80, 40)
    assert shown(photograph(kind), width_px=4000).size == (WIDTH_PX, HEIGHT_PX)
    colour = np.asarray(shown(photograph(kind), width_px=80))[5, 5]
    assert np.abs(colour.astype(int) - (200, 20, 20)).max() < LEVEL_TOLERANCE


@pytest.mark.parametrize(
    ("orientation", "turns", "red_is"),
    [(1, 0, (False, False)), (6, 1, (True, False)), (3, 2, (True, True)), (8, 3, (False, True))],
)
def test_a_picture_is_turned_as_exif_says(orientation: int, turns: int, red_is: tuple[bool, bool]) -> None:
    data = photograph(orientation=orientation)
    assert quarter_turns(data) == turns
    upright = shown(data, width_px=80)
    assert upright.size == ((40, 80) if turns % 2 else (80, 40))
    assert quarter_of_red(upright) == red_is
    assert quarter_of_red(shown(data, width_px=80, upright=False)) == (False, False)


def test_metadata_stays_behind() -> None:
    assert dict(shown(photograph(orientation=6), width_px=80).getexif()) == {}


def test_a_damaged_photograph_says_so() -> None:
    data = photograph()
    with pytest.raises(BadPhoto, match="truncated"):
        display_jpeg(data[: len(data) // 2], DisplayOptions(80), LIMITS)
    assert quarter_turns(b"nothing") == 0
