"""Dots marked by hand join what a detector saw: they override its dots, add to its targets, or make targets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.geometry.marks import Mark
from app.geometry.observations import Detection, TargetObservation
from app.targets.layout import DOT_COUNT, dot_centres_u

FEWEST_MARKS = 4  # of a target that no detector saw: a planar pose takes four dots
PLANE = 2  # dimensions that the marks of such a target must span


def with_marks(detection: Detection, marks: Sequence[Mark]) -> Detection:
    """A detection with the marks of its photograph.

    Marks of a target that was not seen and that are fewer than four, or in one line, are left out.

    Parameters
    ----------
    marks : sequence of Mark
        Each dot once.
    """
    seen = {target.code: target for target in detection.targets}
    for code in sorted({mark.code for mark in marks}):
        own = [mark for mark in marks if mark.code == code]
        if code in seen:
            seen[code] = _marked(seen[code], own)
        elif _suffice(own):
            seen[code] = _marked(_outlined(own), own)
    return replace(detection, targets=tuple(seen.values()))


def _suffice(marks: Sequence[Mark]) -> bool:
    cells_u = dot_centres_u()[[mark.cell for mark in marks]]
    return len(marks) >= FEWEST_MARKS and np.linalg.matrix_rank(cells_u - cells_u.mean(axis=0)) == PLANE


def _marked(target: TargetObservation, marks: Sequence[Mark]) -> TargetObservation:
    """The target with the marks in the place of its dots."""
    centres_px, covariances_px2 = target.centres_px.copy(), target.covariances_px2.copy()
    measured = target.measured.copy()
    for mark in marks:
        centres_px[mark.cell] = mark.position_px
        covariances_px2[mark.cell] = mark.sigma_px**2 * np.eye(2)
        measured[mark.cell] = True
    return replace(target, centres_px=centres_px, covariances_px2=covariances_px2, measured=measured)


def _outlined(marks: Sequence[Mark]) -> TargetObservation:
    """A target of which nothing is measured yet, its dots about where the marks let expect them.

    An affine fit, as dots that are not measured carry no information and only have to lie near the plate.
    """
    cells = [mark.cell for mark in marks]
    plate = np.column_stack([dot_centres_u(), np.ones(DOT_COUNT)])
    image_from_plate = np.linalg.lstsq(plate[cells], np.array([mark.position_px for mark in marks]), rcond=None)[0]
    variance_px2 = max(mark.sigma_px for mark in marks) ** 2
    covariances_px2: npt.NDArray[np.float64] = np.broadcast_to(variance_px2 * np.eye(2), (DOT_COUNT, 2, 2)).copy()
    return TargetObservation(marks[0].code, plate @ image_from_plate, covariances_px2, np.zeros(DOT_COUNT, np.bool_))
