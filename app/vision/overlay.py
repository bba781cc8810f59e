"""Draw what a detector found and refused, as in the paper's Figures 6, 8 and 9."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from app.geometry.observations import Detection, Rejected, TargetObservation
from app.targets.layout import BASE_CELLS

Pixels = npt.NDArray[np.uint8]
Points = npt.NDArray[np.float64]

OUTLINE = (0, 0, 0)
TEXT_SIZE = 0.4
TEXT_GAP_PX = 8.0
SUBPIXEL_BITS = 4  # OpenCV draws at 1/16 px


@dataclass(frozen=True)
class OverlayOptions:
    """Colours (blue, green, red) and sizes of a drawing.

    Attributes
    ----------
    found, found_base, refused : tuple of int
        Measured dots, base dots, refused groups.
    reference_width_px : float
        Strokes and letters grow with the photograph's width; at this width they have their base size.
    """

    found: tuple[int, int, int] = (255, 220, 0)
    found_base: tuple[int, int, int] = (0, 255, 255)
    refused: tuple[int, int, int] = (255, 0, 255)
    reference_width_px: float = 1600.0


def draw_detection(bgr: Pixels, detection: Detection, options: OverlayOptions = OverlayOptions()) -> Pixels:
    """A copy of the photograph with codes and measured dots, and refused groups with their reasons."""
    canvas = bgr.copy()
    scale = max(bgr.shape[1] / options.reference_width_px, 0.5)
    for rejected in detection.rejected:
        _draw_refused(canvas, rejected, scale, options)
    for target in detection.targets:
        _draw_target(canvas, target, scale, options)
    return canvas


def _draw_target(canvas: Pixels, target: TargetObservation, scale: float, options: OverlayOptions) -> None:
    corners_px = target.centres_px[list(BASE_CELLS[:4])]
    _polygon(canvas, corners_px, options.found, scale)
    for cell, centre_px in enumerate(target.centres_px):
        if target.measured[cell]:
            colour = options.found_base if cell in BASE_CELLS else options.found
            _cross(canvas, centre_px, colour, scale)
    notes = "".join([f" c{target.corrected}" * bool(target.corrected), f" e{target.erased}" * bool(target.erased)])
    _text(canvas, f"{target.code}{notes}", corners_px, options.found, scale)


def _draw_refused(canvas: Pixels, rejected: Rejected, scale: float, options: OverlayOptions) -> None:
    corners_px = rejected.centre_px[None] if rejected.corners_px is None else rejected.corners_px
    if len(corners_px) > 1:
        _polygon(canvas, corners_px, options.refused, scale)
    else:
        _cross(canvas, rejected.centre_px, options.refused, 3.0 * scale)
    _text(canvas, rejected.reason, corners_px, options.refused, scale)


def _polygon(canvas: Pixels, corners_px: Points, colour: tuple[int, int, int], scale: float) -> None:
    points = _fixed(corners_px)[:, None]
    cv2.polylines(canvas, [points], True, colour, max(1, round(scale)), cv2.LINE_AA, SUBPIXEL_BITS)


def _cross(canvas: Pixels, centre_px: Points, colour: tuple[int, int, int], scale: float) -> None:
    arm_px = 2.0 * scale
    for direction in (np.array([arm_px, 0.0]), np.array([0.0, arm_px])):
        start, end = _fixed(np.stack([centre_px - direction, centre_px + direction]))
        cv2.line(canvas, start.tolist(), end.tolist(), colour, 1, cv2.LINE_AA, SUBPIXEL_BITS)


def _text(canvas: Pixels, text: str, corners_px: Points, colour: tuple[int, int, int], scale: float) -> None:
    """Text above a group of points, on a dark ground that keeps it legible on any wall."""
    size = TEXT_SIZE * scale
    (width_px, height_px), descent_px = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, size, 1)
    left = int(corners_px[:, 0].mean() - width_px / 2)
    bottom = int(corners_px[:, 1].min() - TEXT_GAP_PX * scale)
    ground = (left - 1, bottom - height_px - 1), (left + width_px + 1, bottom + descent_px)
    cv2.rectangle(canvas, *ground, OUTLINE, cv2.FILLED)
    cv2.putText(canvas, text, (left, bottom), cv2.FONT_HERSHEY_SIMPLEX, size, colour, 1, cv2.LINE_AA)


def _fixed(points_px: Points) -> npt.NDArray[np.int32]:
    limited = np.clip(points_px, -1e5, 1e5)  # OpenCV's fixed point holds no more
    result: npt.NDArray[np.int32] = np.rint(limited * 2**SUBPIXEL_BITS).astype(np.int32)
    return result
