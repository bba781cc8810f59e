"""The published method, step 2: five ellipses that are the base dots of one target.

Letters as in the paper: a = E, b = A, c = C, d and e = B and D, f = the crossing of the diagonals. Source and equation
numbers: Sensors 2019, as in ``paper_ellipses``.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from app.vision.homography import cross
from app.vision.paper_ellipses import Ellipse

Array = npt.NDArray[np.float64]

BASE_COUNT = 5
CROSS_RATIO = 0.5  # (ab, fc) of the plate, in every perspective view


@dataclass(frozen=True)
class GroupOptions:
    """Tolerances of the five-dot geometry; the paper names the tests, not the numbers.

    Attributes
    ----------
    axes_ratio_max : float
        Largest semi-major over smallest semi-minor axis of the five: the paper's 2.
    off_line_max : float
        How far E, and the midpoint of B and D, may lie off the diagonal, over the diagonal's length. The midpoint
        leaves it by perspective alone: by 0.04 for a plate seen at 60 degrees from two and a half times its size; half
        a pixel on the diagonal of the smallest plates is another 0.02.
    cross_ratio_tolerance : float
        Half a pixel in the places of E and f, on a diagonal of 14 px (the smallest plates, seen at 60 degrees), changes
        the cross-ratio by 0.11.
    """

    axes_ratio_max: float = 2.0
    off_line_max: float = 0.06
    cross_ratio_tolerance: float = 0.15


def group_base_dots(ellipses: list[Ellipse], options: GroupOptions) -> tuple[list[list[int]], list[list[int]]]:
    """Groups of five ellipses.

    Returns
    -------
    groups : list of list of int
        Indices of A, B, C, D, E; an ellipse belongs to one group at most.
    refused : list of list of int
        Five neighbours that lie apart and are of one size, but in no arrangement of a target.
    """
    centres_px = np.array([ellipse.centre_px for ellipse in ellipses]).reshape(-1, 2)
    free = np.ones(len(ellipses), dtype=np.bool_)
    groups: list[list[int]] = []
    refused: list[list[int]] = []
    for base in range(len(ellipses)):
        if not free[base] or free.sum() < BASE_COUNT:
            continue
        distances_px = np.where(free, np.linalg.norm(centres_px - centres_px[base], axis=1), np.inf)
        five = np.argsort(distances_px, kind="stable")[:BASE_COUNT].tolist()  # eq. 3: the base and its four nearest
        if not alike_and_apart([ellipses[i] for i in five], options):
            continue
        order = arrange(centres_px[five], options)
        if order is None:
            refused.append(five)
            continue
        groups.append([five[i] for i in order])
        free[five] = False
    taken = {index for group in groups for index in group}
    return groups, [five for five in refused if not taken.intersection(five)]


def alike_and_apart(five: list[Ellipse], options: GroupOptions) -> bool:
    """Whether none includes or cuts another, and all are of about one size."""
    majors_px, minors_px = zip(*(ellipse.semi_axes_px for ellipse in five), strict=True)
    if max(majors_px) > options.axes_ratio_max * min(minors_px):
        return False
    for one, other in combinations(five, 2):
        between_px = other.centre_px - one.centre_px
        distance_px = float(np.linalg.norm(between_px))
        if distance_px == 0.0:
            return False
        direction = between_px / distance_px
        if distance_px <= one.reach_px(direction) + other.reach_px(direction):
            return False
    return True


def arrange(centres_px: Array, options: GroupOptions) -> list[int] | None:
    """Which of five points, shape (5, 2), are A, B, C, D, E; None when they are not a target's.

    The two farthest apart are tried as the diagonal first, then the next pair: in half of all views B and D lie
    farther apart than A and C.
    """
    pairs = sorted(
        combinations(range(BASE_COUNT), 2),
        key=lambda pair: -float(np.linalg.norm(np.diff(centres_px[list(pair)], axis=0))),
    )
    for pair in pairs:
        rest = [i for i in range(BASE_COUNT) if i not in pair]
        for a in rest:
            d, e = (i for i in rest if i != a)
            b, c = sorted(pair, key=lambda i: float(np.linalg.norm(centres_px[i] - centres_px[a])))
            if is_target(centres_px[[a, b, c, d, e]], options):
                return _named((a, b, c, d, e), centres_px)
    return None


def is_target(abcde_px: Array, options: GroupOptions) -> bool:
    """The paper's tests of five points in its letters, shape (5, 2)."""
    a, b, c, d, e = abcde_px
    diagonal_px = c - b
    length2_px2 = float(diagonal_px @ diagonal_px)
    if length2_px2 == 0.0:
        return False

    def off_line(point_px: Array) -> float:
        return float(cross(diagonal_px, point_px - b)) / length2_px2

    if abs(off_line(a)) > options.off_line_max or abs(off_line((d + e) / 2)) > options.off_line_max:
        return False
    side_d, side_e = off_line(d), off_line(e)
    if side_d * side_e >= 0:
        return False
    f = d + side_d / (side_d - side_e) * (e - d)  # where the other diagonal crosses (eq. 4-5)
    at_a, at_f = (float((point - b) @ diagonal_px) / length2_px2 for point in (a, f))  # along b c
    if at_a in (0.0, 1.0) or at_f in (0.0, 1.0):
        return False
    at_b, at_c = 0.0, 1.0
    cross_ratio = ((at_f - at_a) * (at_c - at_b)) / ((at_c - at_a) * (at_f - at_b))  # eq. 6: (af * bc) / (ac * bf)
    return abs(cross_ratio - CROSS_RATIO) <= options.cross_ratio_tolerance


def _named(letters: tuple[int, int, int, int, int], centres_px: Array) -> list[int]:
    """A, B, C, D, E of the paper's a, b, c, d, e: A, B, C, D run clockwise."""
    a, b, c, d, e = letters
    clockwise = cross(centres_px[d] - centres_px[b], centres_px[c] - centres_px[b]) > 0
    return [b, d, c, e, a] if clockwise else [b, e, c, d, a]
