"""A plate drawn to be printed (SVG in mm, PNG) or shown: exact geometry, colours of the print.

Colours are sRGB as targets.md fixes them; positions come from ``layout`` alone.
"""

from __future__ import annotations

import struct
import zlib

import cv2
import numpy as np
import numpy.typing as npt

from app.targets.digits import BLACK, DIGIT_BASE, GREEN, WHITE, digits_of_code
from app.targets.layout import (
    BASE_CELLS,
    CELLS_PER_SIDE,
    DEFAULT_U_M,
    DIGIT_CELLS,
    DOT_COUNT,
    DOT_PITCH_U,
    DOT_RADIUS_U,
    EDGE_TO_DOT_U,
    PLATE_SIDE_U,
    dots_from_corner_u,
)

Image = npt.NDArray[np.uint8]

RED_RGB = (200, 28, 36)
GREEN_RGB = (10, 150, 62)
WHITE_RGB = (238, 238, 232)
BLACK_RGB = (24, 24, 26)
PAPER_RGB = (255, 255, 255)
LABEL_RGB = (120, 120, 120)

MM_PER_M = 1000.0
DEFAULT_U_MM = DEFAULT_U_M * MM_PER_M
LABEL_MIN_MARGIN_U = 1.0  # a narrower margin has no room for a readable code
LABEL_HEIGHT_U = 0.5
SUBPIXELS = 8  # per pixel and axis: edge coverage in steps of 1/64, finer than 8 bits of most edges can show

PNG_SIGNATURE_AND_HEADER_BYTES = 8 + 25  # signature, then the IHDR chunk, which PNG puts first
PNG_UNIT_IS_METRE = 1


def cell_colours_rgb(code: int) -> Image:
    """Colours of the sixteen dots of a code, shape (16, 3), sRGB, row-major cells."""
    by_digit = np.zeros((DIGIT_BASE, 3), dtype=np.uint8)
    by_digit[BLACK], by_digit[GREEN], by_digit[WHITE] = BLACK_RGB, GREEN_RGB, WHITE_RGB
    colours = np.empty((DOT_COUNT, 3), dtype=np.uint8)
    colours[list(BASE_CELLS)] = RED_RGB
    colours[list(DIGIT_CELLS)] = by_digit[digits_of_code(code)]
    return colours


def plate_rgb(code: int, pixels_per_u: int) -> Image:
    """The bare plate as pixels, shape (13 n, 13 n, 3), sRGB, for n pixels per u.

    Dot edges are anti-aliased by area coverage, alike on all sides, so that a dot's centroid is its centre.

    Raises
    ------
    ValueError
        When ``pixels_per_u`` is less than 1 or the code lies outside the range.
    """
    if pixels_per_u < 1:
        raise ValueError(f"a plate needs at least one pixel per u, got {pixels_per_u}")
    coverage = _dot_coverage(pixels_per_u)[..., None]
    black = np.array(BLACK_RGB, dtype=np.float64)
    side = round(PLATE_SIDE_U) * pixels_per_u
    plate = np.broadcast_to(np.array(BLACK_RGB, dtype=np.uint8), (side, side, 3)).copy()
    for cell, colour in enumerate(cell_colours_rgb(code).astype(np.float64)):
        row, column = (round(EDGE_TO_DOT_U - DOT_RADIUS_U + DOT_PITCH_U * i) for i in divmod(cell, CELLS_PER_SIDE))
        top, left, reach = row * pixels_per_u, column * pixels_per_u, len(coverage)
        plate[top : top + reach, left : left + reach] = np.rint(black + coverage * (colour - black))
    return plate


def plate_png(code: int, pixels_per_u: int = 100, u_mm: float = DEFAULT_U_MM, margin_u: int = 0) -> bytes:
    """The plate as a PNG that says how large it is to be printed.

    Parameters
    ----------
    code : int
        What the dots say.
    pixels_per_u : int
        Resolution; 100 prints the default size at 181 dpi.
    u_mm : float
        Printed module; stands in the file's physical size (pHYs), which print dialogues obey at 100 %.
    margin_u : int
        White paper around the plate, in u.
    """
    margin_px = margin_u * pixels_per_u
    plate = plate_rgb(code, pixels_per_u)
    page = np.pad(plate, ((margin_px, margin_px), (margin_px, margin_px), (0, 0)), constant_values=PAPER_RGB[0])
    encoded, png = cv2.imencode(".png", np.ascontiguousarray(page[..., ::-1]))
    if not encoded:
        raise RuntimeError(f"OpenCV could not encode the plate of code {code} as PNG")
    return _with_physical_size(png.tobytes(), pixels_per_u / u_mm * MM_PER_M)


def plate_svg(code: int, u_mm: float = DEFAULT_U_MM, margin_u: float = 0.0) -> str:
    """The plate as SVG whose user unit is the millimetre, to be printed at 100 %.

    With a margin of at least one u the code stands below the plate, outside of what a reader measures.
    """
    if not u_mm > 0 or margin_u < 0:
        raise ValueError("u_mm must be positive and margin_u not negative")
    margin_mm = margin_u * u_mm
    plate_mm = PLATE_SIDE_U * u_mm
    page = f"{plate_mm + 2 * margin_mm:.4f}"
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{page}mm" height="{page}mm" viewBox="0 0 {page} {page}">',
        f"<title>Scattermark target {code}</title>",
        f'<rect width="{page}" height="{page}" fill="{_hex(PAPER_RGB)}"/>',
        f'<rect x="{margin_mm:.4f}" y="{margin_mm:.4f}" width="{plate_mm:.4f}" height="{plate_mm:.4f}"'
        f' fill="{_hex(BLACK_RGB)}"/>',
        *_svg_dots(code, u_mm, margin_mm),
    ]
    if margin_u >= LABEL_MIN_MARGIN_U:
        lines.append(_svg_label(code, u_mm, margin_mm))
    return "\n".join([*lines, "</svg>\n"])


def _svg_dots(code: int, u_mm: float, margin_mm: float) -> list[str]:
    dots = []
    centres_mm = margin_mm + dots_from_corner_u() * u_mm
    for (x_mm, y_mm), colour in zip(centres_mm.tolist(), cell_colours_rgb(code).tolist(), strict=True):
        if tuple(colour) == BLACK_RGB:
            continue  # a black dot is the plate itself
        radius_mm = DOT_RADIUS_U * u_mm
        dots.append(f'<circle cx="{x_mm:.4f}" cy="{y_mm:.4f}" r="{radius_mm:.4f}" fill="{_hex(tuple(colour))}"/>')
    return dots


def _svg_label(code: int, u_mm: float, margin_mm: float) -> str:
    x_mm = margin_mm + PLATE_SIDE_U * u_mm / 2
    y_mm = margin_mm + PLATE_SIDE_U * u_mm + (margin_mm + LABEL_HEIGHT_U * u_mm) / 2
    return (
        f'<text x="{x_mm:.4f}" y="{y_mm:.4f}" font-family="sans-serif" font-size="{LABEL_HEIGHT_U * u_mm:.4f}"'
        f' text-anchor="middle" fill="{_hex(LABEL_RGB)}">{code}</text>'
    )


def _hex(rgb: tuple[int, ...]) -> str:
    return "#" + "".join(f"{value:02x}" for value in rgb)


def _dot_coverage(pixels_per_u: int) -> npt.NDArray[np.float64]:
    """Share of each pixel of the square about a dot (2 u x 2 u) that lies inside the dot."""
    side = round(2 * DOT_RADIUS_U) * pixels_per_u
    subpixel = (np.arange(side * SUBPIXELS) + 0.5) / (pixels_per_u * SUBPIXELS) - DOT_RADIUS_U
    inside = subpixel[:, None] ** 2 + subpixel[None, :] ** 2 <= DOT_RADIUS_U**2
    return np.asarray(inside.reshape(side, SUBPIXELS, side, SUBPIXELS).mean(axis=(1, 3)))


def _with_physical_size(png: bytes, pixels_per_m: float) -> bytes:
    """Insert the pHYs chunk (PNG specification, 11.3.5.3), which OpenCV does not write."""
    pixels = round(pixels_per_m)
    body = b"pHYs" + struct.pack(">IIB", pixels, pixels, PNG_UNIT_IS_METRE)
    chunk = struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))
    return png[:PNG_SIGNATURE_AND_HEADER_BYTES] + chunk + png[PNG_SIGNATURE_AND_HEADER_BYTES:]
