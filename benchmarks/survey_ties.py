"""How honest covariances are where they are worst: the far end of a corridor, and targets tied to an older map."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.control import Role
from app.geometry.pose import Pose
from app.geometry.rotation import log_rotation
from app.geometry.target_map import MappedTarget, TargetMap
from app.photogrammetry.survey import PlateSpec, SurveyPhoto, SurveyResult, adjust_survey
from app.services.extend_map import extend_map
from app.services.tied_survey import Tie as TiedTo
from app.services.tied_survey import adjust_tied
from benchmarks.building import FAMILY, Building, BuildingOptions, build_building
from benchmarks.building_views import U_M, ViewOptions, control_point, photograph, spread_control

Array = npt.NDArray[np.float64]

CORRIDOR = BuildingOptions(wings=0, cross_plates=240, cross_photos=160, lone_corridor_m=60.0)
HELD_SHARE, FAR_SHARE = 0.1, 0.9  # of the corridor's length: control stands before, the far end begins behind
CONTROL_POINTS, CONTROL_SIGMA_M = 6, 0.001
EXTENDED = BuildingOptions(wings=1, bays=2)
OLD_SHARE = 0.6  # of the building's photographs, in the order they were taken, were there in the first survey
MOVED_PLATES, MOVED_M = 2, 0.03
SECOND_NOISE = 1_000  # added to a seed: the second survey's noise is its own


@dataclass(frozen=True)
class Drift:
    """The far end of a corridor that is held at the other.

    Attributes
    ----------
    targets : int
        At the far end.
    error_m, sigma_m : float
        Root mean square 3-D error, and what the covariances say of it.
    nees : float
        Mean normalised error squared of their positions, datum included; 3 expected on average over many surveys.
    """

    targets: int
    error_m: float
    sigma_m: float
    nees: float


@dataclass(frozen=True)
class Tie:
    """A map extended by a second survey.

    Attributes
    ----------
    old, added : int
        Targets of the first map, and those that came.
    moved, moved_named, moved_falsely : int
        Old targets that were moved and seen again, how many were named, and how many others.
    error_m : float
        Root mean square 3-D error of the targets that came.
    nees : float
        Mean normalised error squared of their poses, datum included; 6 expected.
    """

    old: int
    added: int
    moved: int
    moved_named: int
    moved_falsely: int
    error_m: float
    nees: float


def corridor_drift(seed: int) -> Drift:
    """Survey a corridor whose control points stand at its south end."""
    building = build_building(CORRIDOR, seed)
    photos = photograph(building, ViewOptions(), seed)
    south, north = CORRIDOR.cross_m
    place = {code: (pose.position_m[1] - south) / (north - south) for code, pose in building.plates.items()}
    rng = np.random.default_rng(seed)
    seen = np.unique([one.code for photo in photos for one in photo.detection.targets], return_counts=True)
    held = [int(code) for code, rays in zip(*seen, strict=True) if place[int(code)] < HELD_SHARE and rays > 2]
    codes = rng.choice(held, CONTROL_POINTS, replace=False).tolist()
    how: tuple[Role, float] = ("control", CONTROL_SIGMA_M)
    control = [control_point(building, code, index, how, rng) for index, code in enumerate(codes)]
    result = adjust_survey(photos, control, PlateSpec(FAMILY, U_M))
    far = [target for target in result.target_map.targets if place[target.code] > FAR_SHARE]
    errors = [_error(target, building)[:3] for target in far]
    covariances = [_covariance(target, result.target_map)[:3, :3] for target in far]
    return Drift(
        len(far),
        _rms(errors),
        float(np.sqrt(np.mean([np.trace(covariance) for covariance in covariances]))),
        float(np.mean([e @ np.linalg.solve(q, e) for e, q in zip(errors, covariances, strict=True)])),
    )


def extension(seed: int) -> Tie:
    """Map a part of a building, move some plates, and extend the map by a second survey of the whole."""
    building = build_building(EXTENDED, seed)
    rng = np.random.default_rng(seed)
    first = photograph(building, ViewOptions(), seed)
    early = first[: int(OLD_SHARE * len(first))]
    base = _surveyed(building, early, seed)
    codes = sorted(base.target_map.by_code)
    moved = {int(code) for code in rng.choice(codes, MOVED_PLATES, replace=False)}
    later = replace(building, plates={**building.plates, **{code: _pushed(building.plates[code]) for code in moved}})
    photos = photograph(later, ViewOptions(), seed + SECOND_NOISE)
    survey = adjust_tied(photos, TiedTo(base.target_map))
    extended = extend_map(base.target_map, survey.target_map, ())
    seen_again = moved & survey.target_map.by_code.keys()
    came = [extended.target_map.by_code[code] for code in extended.added]
    errors = [_error(target, later) for target in came]
    covariances = [_covariance(target, extended.target_map) for target in came]
    return Tie(
        len(codes),
        len(came),
        len(seen_again),
        len(seen_again & set(extended.moved)),
        len(set(extended.moved) - moved),
        _rms([error[:3] for error in errors]),
        float(np.mean([e @ np.linalg.solve(q, e) for e, q in zip(errors, covariances, strict=True)])),
    )


def _surveyed(building: Building, photos: tuple[SurveyPhoto, ...], seed: int) -> SurveyResult:
    """A first survey, with control on plates that it shows."""
    seen, rays = np.unique([one.code for photo in photos for one in photo.detection.targets], return_counts=True)
    shown = {int(code): building.plates[int(code)] for code in seen[rays > 2]}
    control = spread_control(replace(building, plates=shown), (CONTROL_POINTS, 0), CONTROL_SIGMA_M, seed)
    return adjust_survey(photos, control, PlateSpec(FAMILY, U_M))


def _pushed(pose: Pose) -> Pose:
    return Pose(pose.rotation, pose.position_m + MOVED_M * pose.rotation[:, 0])


def _error(target: MappedTarget, building: Building) -> Array:
    """Position (m) and small rotation (rad) by which the target is off, shape (6,)."""
    pose, true = target.site_from_target, building.plates[target.code]
    return np.concatenate([true.position_m - pose.position_m, log_rotation(true.rotation @ pose.rotation.T)])


def _covariance(target: MappedTarget, target_map: TargetMap) -> Array:
    return target.covariance + target_map.datum.pose_covariance(target.site_from_target.position_m)


def _rms(errors_m: list[Array]) -> float:
    return float(np.sqrt(np.mean([error @ error for error in errors_m])))
