import cv2
import numpy as np
import pytest

from app.vision.kernels.labels import label_blobs
from app.vision.kernels.peaks import PEAK_WINDOW_PX, SMOOTH_PX, TILE_COLUMNS, TILE_ROWS
from app.vision.kernels.redness import SHARE_BITS, measure_redness, shares_of

FLOOR, RATIO = 12, 1.2
MARGIN = SMOOTH_PX + PEAK_WINDOW_PX


def of_redness(redness: np.ndarray) -> np.ndarray:
    """A picture whose redness, at a gain of 1, is what is given."""
    bgr = np.zeros((*redness.shape, 3), dtype=np.uint8)
    bgr[..., 2] = redness
    return bgr


def labelled(bgr: np.ndarray, gain: float = 1.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Moments of the blobs, redness, and which tiles were looked at."""
    height, width = bgr.shape[:2]
    redness = np.full((height, width), 77, dtype=np.uint8)
    hot = np.full((-(-height // TILE_ROWS), -(-width // TILE_COLUMNS)), 77, dtype=np.uint8)
    measure_redness(bgr, shares_of(gain), shares_of(RATIO), np.uint8(FLOOR), redness, hot)
    return label_blobs(redness, hot, np.uint8(FLOOR)), redness, hot


def reference(redness: np.ndarray) -> np.ndarray:
    """The same by OpenCV, over the whole picture, whose border goes on beyond it: count, sums of x and y."""
    wide = cv2.copyMakeBorder(redness, *[MARGIN] * 4, cv2.BORDER_REPLICATE)
    sums = cv2.boxFilter(wide, cv2.CV_32S, (SMOOTH_PX, SMOOTH_PX), normalize=False)
    smooth = np.rint(sums / SMOOTH_PX**2).astype(np.uint8)
    peak = cv2.dilate(smooth, np.ones((PEAK_WINDOW_PX, PEAK_WINDOW_PX), dtype=np.uint8))
    smooth, peak = (part[MARGIN:-MARGIN, MARGIN:-MARGIN] for part in (smooth, peak))
    lacking = peak.astype(int) - smooth
    marked = ((smooth > lacking) & (smooth > FLOOR)).astype(np.uint8)
    _, _, stats, centres = cv2.connectedComponentsWithStats(marked)
    count = stats[1:, cv2.CC_STAT_AREA]
    return np.column_stack([count, count[:, None] * centres[1:]])


def by_place(moments: np.ndarray) -> np.ndarray:
    return moments[np.lexsort(np.rint(moments[:, :3]).T)]


@pytest.mark.parametrize("size_px", [(1, 1), (5, 200), (70, 90), (64, 256), (131, 77)])
@pytest.mark.parametrize("density", [0.002, 0.02, 0.3])
def test_blobs_are_those_of_the_whole_picture(size_px: tuple[int, int], density: float) -> None:
    rng = np.random.default_rng(size_px[0])
    specks = (rng.random(size_px) < density) * rng.integers(60, 256, size_px)
    grown = cv2.GaussianBlur(specks.astype(np.float32), (0, 0), 1.5) * 6.0
    bgr = of_redness(np.clip(grown, 0, 255).astype(np.uint8))
    moments, redness, _ = labelled(bgr)
    np.testing.assert_array_equal(redness, bgr[..., 2])
    np.testing.assert_allclose(by_place(moments)[:, :3], by_place(reference(redness)), atol=1e-6)


def test_second_moments_are_those_of_the_pixels() -> None:
    picture = np.zeros((60, 90), dtype=np.uint8)
    cv2.ellipse(picture, (40, 30), (13, 6), 25.0, 0.0, 360.0, 200.0, -1)
    moments, redness, _ = labelled(of_redness(picture))
    smooth = cv2.blur(redness, (SMOOTH_PX, SMOOTH_PX))
    peak = cv2.dilate(smooth, np.ones((PEAK_WINDOW_PX, PEAK_WINDOW_PX), dtype=np.uint8))
    y, x = np.nonzero(2 * smooth.astype(int) > peak)
    np.testing.assert_allclose(moments, [[len(x), x.sum(), y.sum(), (x * x).sum(), (y * y).sum(), (x * y).sum()]])


def test_what_is_not_red_is_not_looked_at() -> None:
    picture = np.zeros((4 * TILE_ROWS, 4 * TILE_COLUMNS), dtype=np.uint8)
    picture[20:24, 70:74] = 255  # within the second tile of the second row
    _, _, hot = labelled(of_redness(picture))
    assert np.argwhere(hot).tolist() == [[1, 1]]
    picture[TILE_ROWS, TILE_COLUMNS - 1] = 255  # a corner touches four tiles
    _, _, hot = labelled(of_redness(picture))
    assert np.argwhere(hot).tolist() == [[0, 0], [0, 1], [1, 0], [1, 1]]


def test_redness_is_red_over_the_greater_of_the_others() -> None:
    bgr = np.random.default_rng(5).integers(0, 256, (33, 70, 3), dtype=np.uint8)
    _, redness, _ = labelled(bgr, gain=1.1)
    blue, green, red = np.moveaxis(bgr.astype(float), 2, 0)
    expected = np.clip(1.1 * red - RATIO * np.maximum(blue, green), 0.0, 255.0)
    factor_rounding = 255.0 / 2 ** (SHARE_BITS + 1)
    np.testing.assert_allclose(redness, expected, atol=0.501 + 2.0 * factor_rounding)
    exact = (shares_of(1.1) * red - shares_of(RATIO) * np.maximum(blue, green)) / 2**SHARE_BITS
    np.testing.assert_allclose(redness, np.clip(exact, 0.0, 255.0), atol=0.501)


def test_more_labels_than_there_is_room_for_at_first() -> None:
    picture = np.zeros((16 * 80, 16 * 80), dtype=np.uint8)
    picture[4::16, 4::16] = 255
    picture[5::16, 4::16] = 255
    moments, _, _ = labelled(of_redness(picture))
    assert len(moments) == 80 * 80
