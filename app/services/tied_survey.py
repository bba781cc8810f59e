"""A survey adjusted in the frame of a map that it extends, whichever of the map's targets were moved meanwhile."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from app.errors import InvalidControlPoints
from app.geometry.control import ControlPoint
from app.geometry.print_batch import PrintBatch
from app.geometry.target_map import TargetMap
from app.photogrammetry.survey import PlateSpec, SurveyPhoto, SurveyProgress, SurveyResult, adjust_survey
from app.services.extend_map import ExtendOptions, anchored_points, anchors_of

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Tie:
    """What a survey is tied to.

    Attributes
    ----------
    base : TargetMap
    points : tuple of ControlPoint
        Of the site; they only check.
    batches : tuple of PrintBatch
        Of the site.
    options : ExtendOptions
    """

    base: TargetMap
    points: tuple[ControlPoint, ...] = ()
    batches: tuple[PrintBatch, ...] = ()
    options: ExtendOptions = field(default_factory=ExtendOptions)


def adjust_tied(photos: Sequence[SurveyPhoto], tie: Tie, progress: SurveyProgress | None = None) -> SurveyResult:
    """The survey with targets of the base map as its control; an anchor that contradicts the rest is let go of.

    Raises
    ------
    SurveyFailed, InvalidControlPoints
        As ``anchors_of`` and ``adjust_survey``; the latter when more anchors contradict each other than may.
    """
    base, detections = tie.base, [photo.detection for photo in photos]
    plate = PlateSpec(base.code_family, base.u_m, tie.batches)
    standing = base
    for _ in range(tie.options.most_moved_anchors):
        anchors = anchors_of(standing, detections, tie.options)
        try:
            return adjust_survey(photos, anchored_points(anchors, tie.points), plate, progress=progress)
        except InvalidControlPoints as error:
            code = _worst_anchor(anchors, error)
            log.info("target %d of the base map is not where it was; the survey is tied to others", code)
            standing = replace(standing, targets=tuple(one for one in standing.targets if one.code != code))
    anchors = anchors_of(standing, detections, tie.options)
    return adjust_survey(photos, anchored_points(anchors, tie.points), plate, progress=progress)


def _worst_anchor(anchors: Sequence[ControlPoint], error: InvalidControlPoints) -> int:
    """Code of the anchor that explains a contradiction, or is farthest off where no single one does.

    Raises
    ------
    InvalidControlPoints
        The same, when it is about something else.
    """
    if error.fields.get("reason") != "contradiction":
        raise error
    codes = {anchor.name: anchor.code for anchor in anchors}
    mistyped = [suspect["points"][0] for suspect in error.fields["suspects"] if suspect["kind"] == "mistyped"]
    sizes_m = {name: float(np.linalg.norm(row)) for name, row in error.fields["residuals_m"].items()}
    return codes[mistyped[0] if mistyped else max(sizes_m, key=lambda name: sizes_m[name])]
