"""What else shines into the pixels about a dot: the plate's black, its neighbours' light, and the paper's."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.compiled import compiled
from app.targets.layout import CELLS_PER_SIDE, DOT_PITCH_U, PLATE_SIDE_U
from app.vision.kernels.dot_pixels import LIE, blur_factor, disc_at
from app.vision.kernels.profiles import edge_profiles, straight_profile

Array = npt.NDArray[np.float64]
Array32 = npt.NDArray[np.float32]
Indices32 = npt.NDArray[np.int32]

STRAY_BLURS = 3.0  # farther from an edge than this 1e-3 of its light strays
CLEAR_U = DOT_PITCH_U - 1.0  # from a dot's middle to its neighbour's edge, and to the paper's
# Dots' light, planes of black and paper, and the standard deviation of the blur in px and the ring's outer radius in u.
PLATE = "Tuple((float64[:, ::1], float64[:, ::1], float64, float64))"
Plate = tuple[Array, Array, float, float]
# Offsets of pixels, room for what is looked up of them, and the light that they get.
ROOM = "Tuple((float32[:, ::1], int32[::1], float32[:, ::1], float32[:, ::1]))"
Room = tuple[Array32, Indices32, Array32, Array32]


@compiled(f"void({LIE}, float64[:, ::1], int64, {ROOM})")
def set_black(lie: tuple[float, ...], planes: Array, count: int, room: Room) -> None:
    """Light of the plate's black alone."""
    along, down = room[0][0], room[0][1]
    for channel in range(3):
        plane, light = planes[channel], room[3][channel]
        constant = np.float32(plane[0] + plane[1] * lie[2] + plane[2] * lie[3])
        by_x, by_y = np.float32(plane[1]), np.float32(plane[2])
        for at in range(count):
            light[at] = constant + by_x * along[at] + by_y * down[at]


@compiled(f"void({LIE}, int64, float64, float32[:, ::1], {ROOM})")
def _find_neighbour(lie: tuple[float, ...], side: int, blur_px: float, edges: Array32, room: Room) -> None:
    """Shares of the light of the dot beyond a side."""
    pitch_u = DOT_PITCH_U if side % 2 else -DOT_PITCH_U
    offset_u = (0.0, pitch_u) if side // 2 else (pitch_u, 0.0)
    edge_profiles(room[0], disc_at(lie, offset_u, blur_px), edges, room[1], room[2])


@compiled(f"void({LIE}, int64, float64, float32[:, ::1], {ROOM})")
def _find_paper(lie: tuple[float, ...], side: int, blur_u: float, edges: Array32, room: Room) -> None:
    """Shares of the light of the paper beyond a side."""
    axis, towards = side // 2, 1.0 if side % 2 else -1.0
    before_u = PLATE_SIDE_U / 2.0 - towards * lie[2 + axis]
    straight_profile(
        room[0][axis], (np.float32(before_u / blur_u), np.float32(-towards / blur_u)), edges, room[1], room[2][0]
    )


@compiled(f"void(float64, {ROOM}, float32[::1])")
def _add_light(amount: float, room: Room, light: Array32) -> None:
    shares, each = room[2][0], np.float32(amount)
    for at in range(len(room[1])):
        light[at] += shares[at] * each


@compiled(f"void({LIE}, float64[::1], {ROOM}, float32[::1])")
def _add_plane(lie: tuple[float, ...], plane: Array, room: Room, light: Array32) -> None:
    """As ``_add_light``, of a light that grows evenly along x and y."""
    shares, along, down = room[2][0], room[0][0], room[0][1]
    constant = np.float32(plane[0] + plane[1] * lie[2] + plane[2] * lie[3])
    by_x, by_y = np.float32(plane[1]), np.float32(plane[2])
    for at in range(len(room[1])):
        light[at] += shares[at] * (constant + by_x * along[at] + by_y * down[at])


@compiled(f"void({LIE}, int64, {PLATE}, float32[:, ::1], {ROOM})")
def add_stray_light(lie: tuple[float, ...], dot: int, plate: Plate, edges: Array32, room: Room) -> None:
    """Add what comes over the four sides of a dot: a neighbour's light, or the paper's beside an outer dot."""
    amplitudes, planes, blur_px, reach_u = plate
    for side in range(4):
        axis, towards = side // 2, 1 if side % 2 else -1
        blur_u = blur_px * blur_factor(lie, 1.0 - axis, float(axis))
        if reach_u + STRAY_BLURS * blur_u < CLEAR_U:
            continue
        row, column = dot // CELLS_PER_SIDE + axis * towards, dot % CELLS_PER_SIDE + (1 - axis) * towards
        if 0 <= row < CELLS_PER_SIDE and 0 <= column < CELLS_PER_SIDE:
            _find_neighbour(lie, side, blur_px, edges, room)
            for channel in range(3):
                _add_light(amplitudes[CELLS_PER_SIDE * row + column, channel], room, room[3][channel])
        else:
            _find_paper(lie, side, blur_u, edges, room)
            for channel in range(3):
                _add_plane(lie, planes[channel, 3:], room, room[3][channel])
