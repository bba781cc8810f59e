"""A target map against the truth: its shape, its place, and what the control points allow at best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.control import ControlPoint
from app.geometry.rotation import log_rotation
from app.geometry.similarity import Similarity, estimate_similarity
from app.geometry.target_map import MappedTarget, TargetMap
from app.targets.layout import dots_target_m

Array = npt.NDArray[np.float64]

TARGET_DOF = 6
DATUM_DOF = 7


@dataclass(frozen=True)
class MapScore:
    """Root mean square errors over dots (3-D, m) and normalised errors squared.

    Attributes
    ----------
    targets : int
        Targets that map and truth share.
    shape_rmse_m : float
        After the best similarity to the truth.
    absolute_rmse_m : float
        In the site frame.
    floor_rmse_m : float or None
        Of a perfect map fitted to the same control points; None when the map has none.
    check_rmse_m : float or None
        Of the check points, whose own noise is in it.
    target_nees : float
        Mean over targets, after the best similarity, by each target's own covariance; 6 expected.
    datum_nees : float
        Of the similarity to the truth, by the datum's covariance; 7 expected on average over many surveys.
    """

    targets: int
    shape_rmse_m: float
    absolute_rmse_m: float
    floor_rmse_m: float | None
    check_rmse_m: float | None
    target_nees: float
    datum_nees: float


def score_map(target_map: TargetMap, true_dots_m: dict[int, Array], control: Sequence[ControlPoint]) -> MapScore:
    """Score a map in a site frame that the control points fix."""
    targets = [target for target in target_map.targets if target.code in true_dots_m]
    estimated_m = np.concatenate([target.dots_m for target in targets])
    true_m = np.concatenate([true_dots_m[target.code] for target in targets])
    true_from_estimated = estimate_similarity(estimated_m, true_m)
    return MapScore(
        targets=len(targets),
        shape_rmse_m=_rmse(true_from_estimated.apply(estimated_m) - true_m),
        absolute_rmse_m=_rmse(estimated_m - true_m),
        floor_rmse_m=_floor_m(true_dots_m, true_m, control),
        check_rmse_m=_check_m(target_map, control),
        target_nees=float(np.mean([_target_nees(one, true_dots_m, true_from_estimated) for one in targets])),
        datum_nees=_datum_nees(target_map, true_from_estimated),
    )


def _rmse(errors_m: Array) -> float:
    return float(np.sqrt(np.square(errors_m).sum(axis=1).mean()))


def _floor_m(true_dots_m: dict[int, Array], true_m: Array, control: Sequence[ControlPoint]) -> float | None:
    points = [point for point in control if point.role == "control" and point.code in true_dots_m]
    if len(points) < 3:
        return None
    perfect_m = np.array([_place_m(true_dots_m[point.code], point) for point in points])
    measured_m = np.array([point.position_m for point in points])
    return _rmse(estimate_similarity(perfect_m, measured_m).apply(true_m) - true_m)


def _check_m(target_map: TargetMap, control: Sequence[ControlPoint]) -> float | None:
    points = [point for point in control if point.role == "check" and point.code in target_map.by_code]
    if not points:
        return None
    mapped_m = np.array([_place_m(target_map.by_code[point.code].dots_m, point) for point in points])
    return _rmse(mapped_m - np.array([point.position_m for point in points]))


def _place_m(dots_m: Array, point: ControlPoint) -> Array:
    return dots_m.mean(axis=0) if point.cell is None else dots_m[point.cell]


def _target_nees(target: MappedTarget, true_dots_m: dict[int, Array], true_from_estimated: Similarity) -> float:
    dots_m = true_dots_m[target.code]
    site_from_target = estimate_similarity(dots_target_m(1.0), dots_m)  # whatever the print's scale
    pose = target.site_from_target
    position_m = true_from_estimated.apply(pose.position_m[None])[0]
    turn_rad = log_rotation(site_from_target.rotation @ (true_from_estimated.rotation @ pose.rotation).T)
    error = np.concatenate([dots_m.mean(axis=0) - position_m, turn_rad])
    return float(error @ np.linalg.solve(target.covariance, error))


def _datum_nees(target_map: TargetMap, true_from_estimated: Similarity) -> float:
    datum = target_map.datum
    moved_m = true_from_estimated.apply(datum.origin_m[None])[0] - datum.origin_m
    turned_rad = log_rotation(true_from_estimated.rotation)
    error = np.concatenate([moved_m, turned_rad, [np.log(true_from_estimated.scale)]])
    return float(error @ np.linalg.solve(datum.covariance, error))
