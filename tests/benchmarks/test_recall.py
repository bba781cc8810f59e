"""A few cells of the recall matrix, one photograph each: plates are read, and no code is made up."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from app.geometry.observations import Detection, TargetObservation
from app.targets.family import family_by_name
from app.vision.detector import DetectorOptions, detect
from benchmarks.recall import Count, read_photo, score, tasks_of
from benchmarks.recall_conditions import matrix
from benchmarks.recall_views import HardPhoto, PlateTruth, hard_photo

# What the default detector must read of twenty plates; the whole matrix is a command.
LEAST = {
    ("size, px per u", "2"): 19,
    ("one base dot hidden", ""): 12,
    ("gradient, lamp so many u off", "6"): 18,
    ("shadow's edge, light left", "0.5"): 19,
    ("dim, ISO 1600, EV", "-2"): 19,
    ("JPEG 4:2:0, quality", "35"): 18,
}


@pytest.mark.parametrize(("row", "severity"), LEAST)
def test_hard_plates_are_read_and_the_published_method_reads_no_more(row: str, severity: str) -> None:
    task = next(task for task in tasks_of(row, matrix()[row], 1, seed=5) if task.severity == severity)
    plates, counts = read_photo(task)
    assert plates == 20 and counts["default"].wrong == 0
    assert counts["default"].found >= max(LEAST[row, severity], counts["paper"].found)


def test_a_blur_too_soft_makes_no_code_of_plates_in_shadow() -> None:
    """Its plates were read as all white: what strayed from lit dots passed for light in the shadow."""
    family = family_by_name("golay")
    photo = hard_photo(matrix()["shadow's edge, light left"]["0.25"], family.codes, seed=103)
    too_soft = DetectorOptions(blurs_px=(1.9,))
    assert score(detect(photo.bgr, family, too_soft), photo).wrong == 0


def test_every_cell_has_a_photograph_of_its_own_kind() -> None:
    rows = matrix()
    cells = [condition for row in rows.values() for condition in row.values()]
    assert len(cells) > 50
    assert all(one != other for one, other in pairwise(cells))


def test_a_photograph_is_that_of_its_seed() -> None:
    condition = replace(matrix()["casts"]["blue"], plates_max=2)
    codes = family_by_name("golay").codes
    first, again, other = (hard_photo(condition, codes, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.bgr, again.bgr)
    assert {plate.code for plate in first.plates} != {plate.code for plate in other.plates}


def test_a_code_that_hangs_elsewhere_is_wrong() -> None:
    dots_px = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0)), axis=-1).reshape(16, 2) * 12.0 + 100.0
    photo = HardPhoto(np.zeros((1, 1, 3), np.uint8), (PlateTruth(7, dots_px), PlateTruth(8, dots_px + 200.0)))

    def seen(code: int, shift_px: float) -> TargetObservation:
        return TargetObservation(code, dots_px + shift_px, np.tile(np.eye(2), (16, 1, 1)), np.ones(16, dtype=np.bool_))

    targets = (seen(7, 1.0), seen(8, 0.0), seen(9, 200.0))
    assert score(Detection(640, 480, targets), photo) == Count(found=1, wrong=2)
