"""Whether five blobs lie and look like a plate's base dots: sizes, perspective, and black between them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.vision.kernels.homographies import image_of, px_per_u_of, through_corners
from app.vision.kernels.ordering import middle_of, sort_few

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Pixels = npt.NDArray[np.uint8]

RED = 2
E = 4  # of the five base dots
E_U = -1.5  # both its plate coordinates
HALF_PLATE_U = 6.5
QUARTER = 4  # the darkest quarter of the gaps ends at black


@compiled("float64(uint8[:, :, ::1], float64, float64)")
def red_at(bgr: Pixels, x: float, y: float) -> float:
    """Red between pixels, bilinear; the picture's border goes on beyond it."""
    height, width, _ = bgr.shape
    x, y = min(max(x, 0.0), width - 1.0), min(max(y, 0.0), height - 1.0)
    left, top = int(x), int(y)
    right, bottom = min(left + 1, width - 1), min(top + 1, height - 1)
    along, down = x - left, y - top
    above = bgr[top, left, RED] * (1.0 - along) + bgr[top, right, RED] * along
    below = bgr[bottom, left, RED] * (1.0 - along) + bgr[bottom, right, RED] * along
    return above * (1.0 - down) + below * down


@compiled("boolean(float64[:, ::1])")
def _is_convex(corners_px: Array) -> bool:
    """Whether A, B, C, D turn clockwise at every corner: five dots in the other order are not a target."""
    for corner in range(4):
        a, b, c = corners_px[corner], corners_px[(corner + 1) % 4], corners_px[(corner + 2) % 4]
        if (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) <= 0.0:
            return False
    return True


@compiled("boolean(float64[:, ::1], float64)")
def _is_in_front(image_from_plate: Array, depth_ratio_max: float) -> bool:
    """Whether the whole plate is in front of the camera, and its depth varies as a plate's can."""
    along, down, middle = image_from_plate[2]
    change = HALF_PLATE_U * (abs(along) + abs(down))
    return middle > change and (middle - change) * depth_ratio_max > middle + change


@compiled("boolean(float64[:, ::1], float64[:, ::1], float64[::1], UniTuple(float64, 8), float64[::1])")
def _agrees(image_from_plate: Array, base_px: Array, radii_px: Array, bounds: tuple[float, ...], room: Array) -> bool:
    """Whether E is where the corners say, and the blobs are as large as the plate says."""
    _, e_offset_u, e_offset_px, least, most, _, _, _ = bounds
    px_per_u = px_per_u_of(image_from_plate)
    x, y = image_of(image_from_plate, E_U, E_U)
    off_x, off_y, allowed_px = x - base_px[E, 0], y - base_px[E, 1], e_offset_u * px_per_u + e_offset_px
    if not off_x * off_x + off_y * off_y < allowed_px * allowed_px:
        return False
    for dot in range(len(radii_px)):
        room[dot] = radii_px[dot]
    return bool(least * px_per_u < middle_of(room[: len(radii_px)]) < most * px_per_u)


@compiled(
    "float64(uint8[:, :, ::1], float64[:, ::1], float64[:, ::1], Tuple((float64[:, ::1], UniTuple(float64, 8))), "
    "float64[::1])"
)
def _black_between(
    bgr: Pixels, image_from_plate: Array, base_px: Array, known: tuple[Array, tuple[float, ...]], room: Array
) -> float:
    """Red between the dots and the gaps, grey values; 0 where the gaps are not black."""
    gaps_u, (_, _, _, _, _, dark_fraction, dark_gaps_min, contrast_min) = known
    dots, gaps = room[: len(base_px)], room[len(base_px) :]
    for dot in range(len(base_px)):
        dots[dot] = red_at(bgr, base_px[dot, 0], base_px[dot, 1])
    for gap in range(len(gaps_u)):
        x, y = image_of(image_from_plate, gaps_u[gap, 0], gaps_u[gap, 1])
        gaps[gap] = red_at(bgr, x, y)
    sort_few(gaps)
    lit, black = middle_of(dots), gaps[len(gaps) // QUARTER]
    border, dark = black + dark_fraction * (lit - black), 0
    for gap in range(len(gaps)):
        dark += gaps[gap] < border
    return lit - black if dark >= dark_gaps_min and lit - black > contrast_min else 0.0


@compiled(
    "void(uint8[:, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1], UniTuple(float64, 8), float64[::1])"
)
def weigh_groups(
    bgr: Pixels, base_px: Array, radii_px: Array, gaps_u: Array, bounds: tuple[float, ...], contrast: Array
) -> None:
    """Red over black of groups of five blobs, shape (G,), written: grey values, 0 for those that are no plate.

    Parameters
    ----------
    bgr : ndarray of shape (H, W, 3), uint8
    base_px : ndarray of shape (G, 5, 2)
        A, B, C, D, E.
    radii_px : ndarray of shape (G, 5)
        The blobs' mean radii.
    gaps_u : ndarray of shape (M, 2)
        Plate points that are black.
    bounds : tuple of float
        Of ``ProposalOptions`` depth_ratio_max, e_offset_u, e_offset_px, both of size_ratio, dark_fraction,
        dark_gaps_min, red_contrast_min.
    """
    image_from_plate, room = np.empty((3, 3)), np.empty(base_px.shape[1] + len(gaps_u))
    for group in range(len(base_px)):
        contrast[group] = 0.0
        if not _is_convex(base_px[group, :4]):
            continue
        through_corners(base_px[group, :4], image_from_plate)
        in_front = _is_in_front(image_from_plate, bounds[0])
        if in_front and _agrees(image_from_plate, base_px[group], radii_px[group], bounds, room):
            contrast[group] = _black_between(bgr, image_from_plate, base_px[group], (gaps_u, bounds), room)
