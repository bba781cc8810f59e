import cv2
import numpy as np
import pytest

from app.geometry.observations import Detection, Rejected, TargetObservation
from app.targets.family import CodeFamily
from app.targets.layout import BASE_CELLS
from app.vision.detector import detect
from app.vision.homography import PLATE_DOTS_U
from app.vision.overlay import OverlayOptions, draw_detection
from tests.vision.scenes import Shot

OPTIONS = OverlayOptions()
WIDTH, HEIGHT = 640, 480


@pytest.fixture(scope="module")
def detection(plates_shot: Shot, family: CodeFamily) -> Detection:
    return detect(plates_shot.bgr, family)


def target_at(x_px: float, y_px: float, **changes: object) -> TargetObservation:
    values = {
        "code": 389,
        "centres_px": 6.0 * PLATE_DOTS_U + [x_px, y_px],
        "covariances_px2": np.broadcast_to(np.eye(2), (16, 2, 2)),
        "measured": np.ones(16, dtype=bool),
    }
    return TargetObservation(**(values | changes))  # type: ignore[arg-type]


def drawn(*targets: TargetObservation, rejected: tuple[Rejected, ...] = ()) -> np.ndarray:
    grey = np.full((HEIGHT, WIDTH, 3), 90, dtype=np.uint8)
    return draw_detection(grey, Detection(WIDTH, HEIGHT, targets, rejected))


def of_colour(picture: np.ndarray, bgr: tuple[int, int, int]) -> np.ndarray:
    """Where a picture is nearly of that colour: lines are softened."""
    return np.abs(picture.astype(int) - bgr).max(axis=2) < 70


def test_each_target_is_drawn_on_and_the_photograph_kept(plates_shot: Shot, detection: Detection) -> None:
    before = plates_shot.bgr.copy()
    picture = draw_detection(plates_shot.bgr, detection)
    np.testing.assert_array_equal(plates_shot.bgr, before)
    assert picture.shape == before.shape and picture.dtype == np.uint8
    changed = (picture != before).any(axis=2)
    for target in detection.targets:
        for x, y in np.rint(target.centres_px[target.measured]).astype(int):
            assert changed[y - 1 : y + 2, x - 1 : x + 2].any()
    assert changed.mean() < 0.3


def test_nothing_seen_leaves_the_photograph_as_it_is(plates_shot: Shot) -> None:
    np.testing.assert_array_equal(draw_detection(plates_shot.bgr, Detection(WIDTH, HEIGHT, ())), plates_shot.bgr)


def test_base_dots_and_others_have_their_own_colour() -> None:
    target = target_at(320.0, 240.0)
    picture = drawn(target)
    for cell, (x, y) in enumerate(np.rint(target.centres_px).astype(int)):
        colour = OPTIONS.found_base if cell in BASE_CELLS else OPTIONS.found
        assert of_colour(picture[y - 1 : y + 2, x - 1 : x + 2], colour).any()


def test_what_was_not_measured_has_no_cross() -> None:
    measured = np.ones(16, dtype=bool)
    measured[6] = False
    plain, without = drawn(target_at(320.0, 240.0)), drawn(target_at(320.0, 240.0, measured=measured))
    x, y = np.rint(target_at(320.0, 240.0).centres_px[6]).astype(int)
    assert (plain[y - 2 : y + 3, x - 2 : x + 3] != 90).any() and (without[y - 2 : y + 3, x - 2 : x + 3] == 90).all()


def test_mended_and_filled_digits_are_told() -> None:
    plain = drawn(target_at(320.0, 240.0))
    assert (drawn(target_at(320.0, 240.0, corrected=1)) != plain).any()
    assert (drawn(target_at(320.0, 240.0, erased=2)) != plain).any()


def test_the_code_stands_above_the_plate_on_a_ground_of_its_own() -> None:
    target = target_at(800.0, 600.0)
    grey = np.full((1200, 1600, 3), 90, dtype=np.uint8)
    picture = draw_detection(grey, Detection(1600, 1200, (target,)))
    above = picture[: int(target.centres_px[:, 1].min()) - 4]
    letters, ground = of_colour(above, OPTIONS.found), (above == 0).all(axis=2)
    assert letters.any() and ground.sum() > letters.sum()


@pytest.mark.parametrize(
    "corners_px", [None, np.array([[100.0, 100.0], [160.0, 100.0], [160.0, 160.0], [100.0, 160.0]])]
)
def test_refused_groups_are_drawn_with_their_reason(corners_px: np.ndarray | None) -> None:
    refusal = Rejected("wrong-layout", np.array([130.0, 130.0]), corners_px=corners_px)
    picture = drawn(rejected=(refusal,))
    seen = of_colour(picture, OPTIONS.refused)
    around = (130, 130) if corners_px is None else (100, 130)
    assert seen[around[1] - 3 : around[1] + 4, around[0] - 3 : around[0] + 4].any()
    other = drawn(rejected=(Rejected("not-red", np.array([130.0, 130.0]), corners_px=corners_px),))
    assert (other != picture).any()


@pytest.mark.parametrize("place_px", [(-50.0, 20.0), (645.0, 470.0), (1e9, -1e9)])
def test_what_lies_outside_is_drawn_as_far_as_it_shows(place_px: tuple[float, float]) -> None:
    picture = drawn(target_at(*place_px), rejected=(Rejected("outside-photo", np.array(place_px)),))
    assert picture.shape == (HEIGHT, WIDTH, 3)


def test_strokes_grow_with_the_photograph() -> None:
    shares = []
    for factor in (1, 4):
        centres_px = factor * (6.0 * PLATE_DOTS_U + [200.0, 200.0])
        grey = np.full((factor * 400, factor * 800, 3), 90, dtype=np.uint8)
        picture = draw_detection(grey, Detection(0, 0, (target_at(0.0, 0.0, centres_px=centres_px),)))
        shares.append((cv2.absdiff(picture, grey).max(axis=2) > 0).mean())
    assert shares[1] == pytest.approx(shares[0], rel=0.6)
