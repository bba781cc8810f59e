"""The pixels about a dot, and what shines into them, against plain statements."""

import numpy as np
import pytest
from scipy.special import ndtr

from app.targets.layout import PLATE_SIDE_U
from app.vision.kernels.dot_pixels import collect, lie_of, to_plate, unpack, window_of
from app.vision.kernels.stray_light import add_stray_light, set_black
from app.vision.settling import edge_table
from app.vision.template import blurred_disc

# Of a slanted plate, from pixels to plate coordinates, y down.
PLATE_FROM_IMAGE = np.linalg.inv(np.array([[5.0, 0.7, 30.0], [-0.4, 3.0, 22.0], [0.004, -0.003, 1.0]]))
DOTS_PX = [(29.3, 23.6), (7.6, 35.2), (47.9, 12.3)]
SIZE_PX = (60, 48)


@pytest.fixture(scope="module")
def bgr() -> np.ndarray:
    return np.random.default_rng(5).integers(0, 256, (SIZE_PX[1], SIZE_PX[0], 3), dtype=np.uint8)


def offsets_u(points_px: np.ndarray, dot_px: tuple[float, float]) -> np.ndarray:
    """Plate coordinates of pixels less those of a dot."""
    both = np.column_stack([np.vstack([points_px, dot_px]), np.ones(len(points_px) + 1)]) @ PLATE_FROM_IMAGE.T
    places_u: np.ndarray = both[:, :2] / both[:, 2:]
    return places_u[:-1] - places_u[-1]


@pytest.mark.parametrize("dot_px", DOTS_PX)
@pytest.mark.parametrize("inner_u", [0.0, 0.6])
def test_pixels_are_those_of_the_ring(bgr: np.ndarray, dot_px: tuple[float, float], inner_u: float) -> None:
    lie = lie_of(PLATE_FROM_IMAGE, *dot_px)
    window = window_of(lie, 1.4, *SIZE_PX)
    pixels, words = np.zeros((5, 1000), dtype=np.float32), np.zeros(1000, dtype=np.uint32)
    count = collect(bgr, lie, window, (inner_u, 1.4), (pixels, words))
    unpack(words, count, pixels[2:])
    assert 0 < count <= window[2]

    columns, rows = np.meshgrid(np.arange(SIZE_PX[0]), np.arange(SIZE_PX[1]))
    away_px = np.column_stack([columns.ravel(), rows.ravel()]) - dot_px
    by_px = np.array(lie[4:8]).reshape(2, 2)
    away_u = np.linalg.norm(away_px @ by_px.T, axis=1)
    expected = (away_u >= inner_u) & (away_u <= 1.4)
    np.testing.assert_allclose(pixels[:2, :count].T, away_px[expected], atol=1e-4)
    np.testing.assert_array_equal(pixels[2:, :count].T, bgr.reshape(-1, 3)[expected])

    to_plate(lie, count, pixels)
    np.testing.assert_allclose(pixels[:2, :count].T, offsets_u(away_px[expected] + dot_px, dot_px), atol=1e-5)


def test_the_pictures_last_pixel_is_left_alone(bgr: np.ndarray) -> None:
    lie = lie_of(np.eye(3), SIZE_PX[0] - 1.0, SIZE_PX[1] - 1.0)
    pixels, words = np.zeros((5, 1000), dtype=np.float32), np.zeros(1000, dtype=np.uint32)
    count = collect(bgr, lie, window_of(lie, 1.1, *SIZE_PX), (0.0, 1.1), (pixels, words))
    assert sorted(map(tuple, pixels[:2, :count].T)) == [(-1.0, 0.0), (0.0, -1.0)]


def test_plates_seen_from_their_edge_have_no_window() -> None:
    receding = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 1.0]])
    assert window_of(lie_of(receding, 0.0, 0.0), 1.4, *SIZE_PX)[2] == 0


def test_stray_light_is_that_of_neighbours_and_paper() -> None:
    """A corner dot has two neighbours, and paper on two sides."""
    scale, blur_px = 4.0, 1.6
    lie = lie_of(np.diag([1 / scale, 1 / scale, 1.0]), -4.5 * scale, -4.5 * scale)
    rng = np.random.default_rng(8)
    amplitudes, planes = rng.uniform(0.0, 90.0, (16, 3)), rng.uniform(0.0, 5.0, (3, 6))
    x, y = rng.uniform(-1.5, 1.5, (2, 40)).astype(np.float32)
    room = (np.stack([x, y]), np.empty(40, np.int32), np.empty((3, 40), np.float32), np.empty((3, 40), np.float32))
    set_black(lie, planes, 40, room)
    add_stray_light(lie, 0, (amplitudes, planes, blur_px, 1.5), edge_table(), room)

    blur_u = blur_px / scale
    right, below = (blurred_disc(np.hypot(x - dx, y - dy), blur_u)[0] for dx, dy in ((3.0, 0.0), (0.0, 3.0)))
    papers = sum(ndtr((4.5 - PLATE_SIDE_U / 2 - at) / blur_u) for at in (x, y))
    plane = np.stack([np.ones(40), x - 4.5, y - 4.5])
    expected = (
        planes[:, :3] @ plane
        + amplitudes[1][:, None] * right
        + amplitudes[4][:, None] * below
        + papers * (planes[:, 3:] @ plane)
    )
    np.testing.assert_allclose(room[3], expected, atol=0.3)  # 2e-3 of each light
