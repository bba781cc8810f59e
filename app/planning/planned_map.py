"""The map that a survey of a plan's targets will leave: true places, and the uncertainty to be expected."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.planning.plan_file import Plan
from app.planning.plan_view import MapExpectation
from app.planning.scene import PostedTarget
from app.planning.survey_plan import farthest_first

RAYS = 9  # photographs that see a target in a survey of some fifty
RMS_PX = 0.1
SEVEN = 7  # of a similarity


def planned_map(plan: Plan) -> TargetMap:
    """A plan's targets as the map of a survey that has gone well.

    Raises
    ------
    ValueError
        When the plan has no targets.
    """
    if not plan.targets:
        raise ValueError("the plan has no targets")
    targets = tuple(planned_target(target, plan.view.survey) for target in plan.targets)
    centres_m = np.array([target.site_from_target.position_m for target in targets])
    return TargetMap(targets, expected_datum(centres_m, plan.view.survey), plan.family.name, plan.u_m)


def planned_target(posted: PostedTarget, survey: MapExpectation) -> MappedTarget:
    """A target as a survey will know it."""
    variances = [survey.target_sigma_m**2] * 3 + [survey.target_sigma_rad**2] * 3
    return MappedTarget(posted.code, posted.site_from_target, posted.dots_m(), np.diag(variances), RAYS, RMS_PX)


def expected_datum(centres_m: npt.NDArray[np.float64], survey: MapExpectation) -> Datum:
    """The datum of control points that lie at the outermost targets, of which there are centres (N, 3).

    Notes
    -----
    The covariance of a similarity that is fitted to the points. With few targets, or all in one line, what the points
    cannot fix is held: a survey would refuse them.
    """
    origin_m = centres_m.mean(axis=0)
    if survey.control_sigma_m == 0:
        return Datum(origin_m, np.zeros((SEVEN, SEVEN)))
    chosen = farthest_first(centres_m, min(survey.control_points, len(centres_m)))
    jacobian = Datum(origin_m, np.zeros((SEVEN, SEVEN))).point_jacobian(centres_m[chosen]).reshape(-1, SEVEN)
    covariance = survey.control_sigma_m**2 * np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-9)
    return Datum(np.asarray(origin_m, dtype=np.float64), np.asarray(covariance, dtype=np.float64))
