"""What a worker does before its first task, so that no import and no first call falls into a request."""

from __future__ import annotations

import cv2
import numpy as np

WARM_UP_SIZE_PX = (240, 320)  # any size: the first call pays for loading and set-up, not for pixels


def warm_up() -> None:
    """Import what requests need and run it once on a blank picture."""
    blank = np.zeros((*WARM_UP_SIZE_PX, 3), dtype=np.uint8)
    cv2.imdecode(cv2.imencode(".jpg", blank)[1], cv2.IMREAD_COLOR)
