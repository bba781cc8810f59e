import numpy as np
import pytest

from app.planning.imaging import ImagingOptions
from app.targets.drawing import BLACK_RGB, GREEN_RGB, WHITE_RGB, cell_colours_rgb
from app.targets.family import CodeFamily
from app.targets.layout import BASE_CELLS
from app.vision.covering import covered_base_dots
from app.vision.detector import detect
from app.vision.measurement import fit_patches
from app.vision.patches import Pyramid, take_patches
from app.vision.template import PatchGrid
from tests.vision.scenes import (
    U_M,
    Shot,
    before_wall,
    facing_panel,
    photograph,
    plates_in_rows,
    refused,
    true_homographies,
    wrong_plate,
)

COLUMNS, ROWS = 4, 3
LENS_BLUR_PX = 0.75


def shot_of(codes: np.ndarray, role: int, thing_rgb: tuple[int, int, int] | None, dot_rgb: object = None) -> Shot:
    """Plates with a thing before one of their base dots, or printed with another colour there."""
    plates = plates_in_rows(codes, (COLUMNS, ROWS), 5.0, seed=3, slant_deg=40.0)
    things = []
    if thing_rgb is not None:
        size_m = 0.9 * 4.5 * U_M
        things = [facing_panel(0.9 * p.dots_m()[BASE_CELLS[role]], (size_m, size_m), thing_rgb) for p in plates]
    if dot_rgb is not None:
        here = (np.arange(16) == BASE_CELLS[role])[:, None]
        wrong = [np.where(here, dot_rgb, cell_colours_rgb(plate.code)).astype(np.uint8) for plate in plates]
        plates = tuple(wrong_plate(plate, cells_rgb) for plate, cells_rgb in zip(plates, wrong, strict=True))
    return photograph(before_wall(plates, *things), ImagingOptions())


def covered(shot: Shot) -> np.ndarray:
    homographies = true_homographies(shot)
    patches = take_patches(Pyramid.of(shot.bgr, 1), homographies, PatchGrid.FINE)
    fits = fit_patches(patches, np.full(len(homographies), LENS_BLUR_PX))
    return covered_base_dots(shot.bgr, fits, homographies)


def test_nothing_is_covered_in_plain_view(plates_shot: Shot) -> None:
    flags = covered(plates_shot)
    assert flags.shape == (24, 5) and not flags.any()


def test_haze_over_a_plate_covers_nothing(plates_shot: Shot) -> None:
    """A reflection lifts the plate's black and all else."""
    hazy = np.rint(0.6 * plates_shot.bgr.astype(float) + 90.0).astype(np.uint8)
    assert not covered(Shot(hazy, plates_shot.truth)).any()


@pytest.mark.parametrize(("role", "thing_rgb"), [(0, (120, 110, 90)), (2, (60, 80, 150)), (4, (140, 120, 100))])
def test_what_stands_before_a_dot_covers_it(codes: np.ndarray, role: int, thing_rgb: tuple[int, int, int]) -> None:
    flags = covered(shot_of(codes, role, thing_rgb))
    assert flags[:, role].all()
    # Of the other dots E alone stands near enough to be touched by what covers A, and A by what covers E.
    far = [other for other in range(5) if other != role and {other, role} != {0, 4}]
    assert not flags[:, far].any()


@pytest.mark.parametrize(("role", "dot_rgb"), [(0, BLACK_RGB), (1, WHITE_RGB), (3, GREEN_RGB), (4, BLACK_RGB)])
def test_a_plate_printed_without_a_base_dot_is_refused(
    codes: np.ndarray, family: CodeFamily, role: int, dot_rgb: tuple[int, int, int]
) -> None:
    shot = shot_of(codes, role, None, dot_rgb)
    assert not covered(shot).any()
    detection = detect(shot.bgr, family)
    assert not detection.targets
    assert refused(detection).count("base-dot-missing") >= COLUMNS * ROWS - 2  # the odd one is no group at all


def test_something_as_black_as_the_plate_passes_for_it(codes: np.ndarray) -> None:
    """The price of refusing plates of wrong structure."""
    assert not covered(shot_of(codes, 2, BLACK_RGB))[:, 2].any()
