"""Light between the pixels of a photograph, one place after the other."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Light = npt.NDArray[np.float32]
Pixels = npt.NDArray[np.uint8]

CHANNELS = 3

# A photograph's bytes in a row, its height and width, and linear light of its grey values.
PHOTO = "Tuple((uint8[::1], int64, int64, float32[::1]))"
Photo = tuple[Pixels, int, int, Light]
# The first of four bytes around a place, what leads to those to its right and below, and the place's offsets from it.
CORNER = "Tuple((uint64, uint64, uint64, float64, float64))"
Corner = tuple[np.uint64, np.uint64, np.uint64, float, float]


@compiled(f"boolean({PHOTO}, float64, float64)")
def is_inside(photo: Photo, x: float, y: float) -> bool:
    """Whether a place lies between a photograph's outermost pixels."""
    _, height, width, _ = photo
    return bool(0.0 <= x <= width - 1.0 and 0.0 <= y <= height - 1.0)


@compiled(f"{CORNER}({PHOTO}, float64, float64)")
def corner_at(photo: Photo, x: float, y: float) -> Corner:
    """The pixels around a place inside."""
    _, height, width, _ = photo
    left, top = int(x), int(y)
    right, below = CHANNELS if left + 1 < width else 0, CHANNELS * width if top + 1 < height else 0
    return np.uint64(CHANNELS * (top * width + left)), np.uint64(right), np.uint64(below), x - left, y - top


@compiled(f"float64({PHOTO}, {CORNER}, int64)")
def light_at(photo: Photo, corner: Corner, channel: int) -> float:
    """Linear light of a channel between pixels, bilinear in grey values."""
    pixels, _, _, light = photo
    first, right, below, along, down = corner
    at = first + np.uint64(channel)
    upper = pixels[at] * (1.0 - along) + pixels[at + right] * along
    lower = pixels[at + below] * (1.0 - along) + pixels[at + below + right] * along
    return light[np.uint64(int(upper * (1.0 - down) + lower * down + 0.5))]
