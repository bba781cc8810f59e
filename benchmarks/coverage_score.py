"""Which targets a survey should have published: seen often enough, from directions far enough apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from app.cli.room import TrueShots
from app.geometry.target_map import TargetMap
from app.photogrammetry.survey import SurveyPhoto

Array = npt.NDArray[np.float64]

LEAST_RAYS = 3
LEAST_ANGLE_DEG = 5.0


@dataclass(frozen=True)
class CoverageScore:
    """Targets that photographs and geometry carry, and what became of them.

    Attributes
    ----------
    carried : int
        Read in at least three photographs whose true rays span at least five degrees.
    missing : tuple of int
        Codes of those that the map lacks.
    wrong_codes : tuple of int
        Published codes that do not exist.
    """

    carried: int
    missing: tuple[int, ...]
    wrong_codes: tuple[int, ...]


def score_coverage(
    target_map: TargetMap, photos: Sequence[SurveyPhoto], truth: TrueShots, true_dots_m: dict[int, Array]
) -> CoverageScore:
    """Compare what was published with what was seen."""
    rays: dict[int, list[Array]] = {}
    for photo in photos:
        centre_m = truth.shots[photo.name].site_from_cam.position_m
        for target in photo.detection.targets:
            if target.code in true_dots_m:
                ray_m = true_dots_m[target.code].mean(axis=0) - centre_m
                rays.setdefault(target.code, []).append(ray_m / np.linalg.norm(ray_m))
    carried = {code for code, directions in rays.items() if _carries(directions)}
    published = set(target_map.by_code)
    return CoverageScore(len(carried), tuple(sorted(carried - published)), tuple(sorted(published - set(true_dots_m))))


def _carries(directions: Sequence[Array]) -> bool:
    if len(directions) < LEAST_RAYS:
        return False
    least_cosine = min(float(first @ second) for first, second in combinations(directions, 2))
    return least_cosine <= np.cos(np.radians(LEAST_ANGLE_DEG))
