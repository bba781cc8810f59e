"""A survey that extends a published map: the map's targets are its control, its datum stands, new targets are added."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.errors import SurveyFailed
from app.geometry.control import ControlPoint
from app.geometry.observations import Detection
from app.geometry.target_map import MappedTarget, TargetMap

Array = npt.NDArray[np.float64]

CENTRE = "centre"


@dataclass(frozen=True)
class ExtendOptions:
    """How a new survey is tied to a map.

    Attributes
    ----------
    most_anchors : int
        Targets that carry the datum over, spread as widely as they stand. Three would do; a dozen halves their noise,
        and the search for gross errors, which tries every pair, is still quick.
    fewest_anchors : int
        As for control points.
    fewest_rays : int
        Photographs that must show an anchor, as for any published target.
    most_moved_anchors : int
        Anchors that may turn out to have been moved; each is replaced by another target and costs an adjustment.
    moved_sigmas, moved_m : float
        A target further from its old place than both was moved: chance exceeds five sigmas never, and nothing that
        hangs is moved by less than 5 mm on purpose.
    """

    most_anchors: int = 12
    fewest_anchors: int = 3
    fewest_rays: int = 3
    most_moved_anchors: int = 4
    moved_sigmas: float = 5.0
    moved_m: float = 0.005


@dataclass(frozen=True)
class Extension:
    """An extended map and what became of its targets, by code."""

    target_map: TargetMap
    added: tuple[int, ...]
    moved: tuple[int, ...]


def anchors_of(
    base: TargetMap, detections: Sequence[Detection], options: ExtendOptions = ExtendOptions()
) -> tuple[ControlPoint, ...]:
    """Control points that hold a new survey to a map: centres of its targets that the photographs show.

    Raises
    ------
    SurveyFailed
        Reason ``no-common-targets`` when the photographs show too few targets of the map.
    """
    rays = Counter(target.code for detection in detections for target in detection.targets)
    common = [target for target in base.targets if rays[target.code] >= options.fewest_rays]
    if len(common) < options.fewest_anchors:
        raise SurveyFailed(
            f"Only {len(common)} targets of the map that is to be extended are seen in {options.fewest_rays} or more "
            f"of the photographs: photograph at least {options.fewest_anchors} of its targets, not in one line, "
            "together with the new ones.",
            reason="no-common-targets",
            common=[target.code for target in common],
        )
    return tuple(_anchor(target) for target in _spread(common, options.most_anchors))


def anchored_points(anchors: Sequence[ControlPoint], points: Sequence[ControlPoint]) -> tuple[ControlPoint, ...]:
    """Anchors with a site's own points beside them, which then only check: the base map's datum stands."""
    taken = {(anchor.code, anchor.cell) for anchor in anchors}
    checks = [replace(point, role="check") for point in points if (point.code, point.cell) not in taken]
    return (*anchors, *checks)


def extend_map(
    base: TargetMap, survey: TargetMap, excluded: Sequence[int], options: ExtendOptions = ExtendOptions()
) -> Extension:
    """The base map with the survey's new targets, and with those in their new place that were moved.

    Parameters
    ----------
    base : TargetMap
        Its datum and its targets stand.
    survey : TargetMap
        Adjusted with ``anchors_of`` as control, so in the frame of the base; how well it is tied to it becomes part
        of its targets' own covariance.
    excluded : sequence of int
        Codes that shall not be in the result.
    options : ExtendOptions
    """
    tied = {target.code: _tied(target, survey) for target in survey.targets}
    kept = {target.code: target for target in base.targets if target.code not in excluded}
    moved = [code for code in kept.keys() & tied.keys() if _is_moved(kept[code], tied[code], options)]
    added = sorted(tied.keys() - kept.keys())
    merged = {**kept, **{code: tied[code] for code in (*moved, *added)}}
    targets = tuple(merged[code] for code in sorted(merged))
    return Extension(replace(base, targets=targets), tuple(added), tuple(sorted(moved)))


def _anchor(target: MappedTarget) -> ControlPoint:
    sigma_m = float(np.sqrt(np.diag(target.covariance)[:3].mean()))
    position_m = target.site_from_target.position_m
    return ControlPoint(f"target {target.code} of the base map", target.code, CENTRE, position_m, sigma_m, "control")


def _spread(targets: Sequence[MappedTarget], count: int) -> list[MappedTarget]:
    """Targets far from each other: each next one is the farthest from all before it, beginning far from the middle."""
    places_m = np.array([target.site_from_target.position_m for target in targets])
    distances_m = np.linalg.norm(places_m - places_m.mean(axis=0), axis=1)
    chosen = [int(distances_m.argmax())]
    nearest_m = np.linalg.norm(places_m - places_m[chosen[0]], axis=1)
    while len(chosen) < min(count, len(targets)):
        chosen.append(int(nearest_m.argmax()))
        nearest_m = np.minimum(nearest_m, np.linalg.norm(places_m - places_m[chosen[-1]], axis=1))
    return [targets[index] for index in chosen]


def _tied(target: MappedTarget, survey: TargetMap) -> MappedTarget:
    """The target with the tie's uncertainty as its own: it is not shared with the targets of the base."""
    shared = survey.datum.pose_covariance(target.site_from_target.position_m)
    return replace(target, covariance=target.covariance + shared)


def _is_moved(old: MappedTarget, new: MappedTarget, options: ExtendOptions) -> bool:
    step_m = new.site_from_target.position_m - old.site_from_target.position_m
    covariance = (old.covariance + new.covariance)[:3, :3]
    sigmas = float(np.sqrt(step_m @ np.linalg.solve(covariance, step_m)))
    return sigmas > options.moved_sigmas and float(np.linalg.norm(step_m)) > options.moved_m
