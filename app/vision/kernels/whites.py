"""What a photograph shows as white."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled

Pixels = npt.NDArray[np.uint8]

GREYS = 256


@compiled("UniTuple(float64, 3)(uint8[:, :, ::1], int64, float64)")
def brighter_than(bgr: Pixels, step_px: int, share: float) -> tuple[float, float, float]:
    """The blue, green and red that a share of the pixels on a sparse grid do not exceed, each by itself."""
    counts, levels = np.zeros((3, GREYS), dtype=np.int64), np.zeros(3)
    height, width, channels = bgr.shape
    for y in range(0, height, step_px):
        for x in range(0, width, step_px):
            for channel in range(channels):
                counts[channel, bgr[y, x, channel]] += 1
    rank = int(share * (counts[0].sum() - 1))
    for channel in range(channels):
        passed, level = counts[channel, 0], 0
        while passed <= rank:
            level += 1
            passed += counts[channel, level]
        levels[channel] = level
    return levels[0], levels[1], levels[2]
