"""Centre errors on the same dots: a detector that reads only what is easy must not look more accurate for that."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.cli.room import PlateInView, TrueShots
from app.geometry.observations import TargetObservation
from app.photogrammetry.survey import SurveyPhoto
from app.targets.layout import BASE_CELLS
from benchmarks.detection_score import SAME_PLACE_U

Array = npt.NDArray[np.float64]

BASE = list(BASE_CELLS)


def shared_dot_errors(readings: Sequence[Sequence[SurveyPhoto]], truth: TrueShots) -> list[Array]:
    """Errors of base dots on the sightings that all readings have.

    Parameters
    ----------
    readings : sequence of D sequences of SurveyPhoto
        The same photographs, each time by another detector.
    truth : TrueShots

    Returns
    -------
    list of D ndarrays of shape (N, 2)
        Measured - true centre, px, of the base dots that all D detectors measured in plates wholly in view.
    """
    errors_px: list[list[Array]] = [[] for _ in readings]
    for photos in zip(*readings, strict=True):
        seen = [{target.code: target for target in photo.detection.targets} for photo in photos]
        for plate in truth.shots[photos[0].name].plates:
            targets = [by_code.get(plate.code) for by_code in seen if plate.code is not None]
            sightings = [target for target in targets if target is not None and _in_place(target, plate)]
            if len(sightings) == len(readings):
                _add_common_dots(errors_px, sightings, plate)
    return [np.concatenate([np.zeros((0, 2)), *parts]) for parts in errors_px]


def _in_place(target: TargetObservation, plate: PlateInView) -> bool:
    away_px = np.linalg.norm(target.centre_px - plate.dots_px.mean(axis=0))
    return bool(away_px < SAME_PLACE_U * plate.px_per_u)


def _add_common_dots(errors_px: list[list[Array]], sightings: Sequence[TargetObservation], plate: PlateInView) -> None:
    common = [cell for cell in BASE if all(target.measured[cell] for target in sightings)]
    for parts, target in zip(errors_px, sightings, strict=True):
        parts.append((target.centres_px - plate.dots_px)[common])
