"""A survey adjusted in the frame of a map that it extends, whichever of the map's targets were moved meanwhile."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.errors import InvalidControlPoints
from app.geometry.control import ControlPoint
from app.geometry.target_map import TargetMap
from app.photogrammetry.survey import PlateSpec, SurveyPhoto, SurveyProgress, SurveyResult, adjust_survey
from app.services.extend_map import ExtendOptions, anchored_points, anchors_of

log = logging.getLogger(__name__)


def adjust_tied(
    photos: Sequence[SurveyPhoto],
    base: TargetMap,
    points: Sequence[ControlPoint],
    progress: SurveyProgress | None = None,
    options: ExtendOptions | None = None,
) -> SurveyResult:
    """The survey with targets of the base map as its control; an anchor that contradicts the rest is let go of.

    Parameters
    ----------
    photos : sequence of SurveyPhoto
    base : TargetMap
    points : sequence of ControlPoint
        Of the site; they only check.
    progress : callable, optional
    options : ExtendOptions, optional

    Raises
    ------
    SurveyFailed, InvalidControlPoints
        As ``anchors_of`` and ``adjust_survey``; the latter when more anchors contradict each other than may.
    """
    options = options or ExtendOptions()
    plate, detections = PlateSpec(base.code_family, base.u_m), [photo.detection for photo in photos]
    standing = base
    for _ in range(options.most_moved_anchors):
        anchors = anchors_of(standing, detections, options)
        try:
            return adjust_survey(photos, anchored_points(anchors, points), plate, progress=progress)
        except InvalidControlPoints as error:
            code = _worst_anchor(anchors, error)
            log.info("target %d of the base map is not where it was; the survey is tied to others", code)
            standing = replace(standing, targets=tuple(one for one in standing.targets if one.code != code))
    anchors = anchors_of(standing, detections, options)
    return adjust_survey(photos, anchored_points(anchors, points), plate, progress=progress)


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
