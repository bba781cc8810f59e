"""Why a photograph has no pose and a target is not published, in words that say what to do."""

from __future__ import annotations

import numpy as np

from app.errors import SurveyFailed
from app.photogrammetry.choose_network import describe_part
from app.photogrammetry.control import StandingTargets
from app.photogrammetry.report import LeftOutRecord
from app.photogrammetry.survey_input import OVERLAP_ADVICE, SurveyInput, Unoriented
from app.photogrammetry.survey_outcome import SurveyOutcome


def check_published(survey: SurveyInput, standing: StandingTargets) -> None:
    """Refuse a survey that publishes nothing.

    Raises
    ------
    SurveyFailed
        Reason ``no-intersection``.
    """
    if not standing.published.any():
        raise SurveyFailed(
            f"None of the {len(survey.codes)} targets is seen from three places whose rays meet at 5 degrees or more: "
            f"{OVERLAP_ADVICE}.",
            reason="no-intersection",
        )


def unoriented_photos(outcome: SurveyOutcome) -> tuple[Unoriented, ...]:
    """Photographs without a pose, each with its reason, in the order of their names."""
    survey = outcome.survey
    oriented = set(outcome.clean.part.photos.tolist())
    found = [
        Unoriented(name, _reason(outcome, photo)) for photo, name in enumerate(survey.names) if photo not in oriented
    ]
    return tuple(sorted((*survey.refused, *found), key=lambda photo: photo.name))


def _reason(outcome: SurveyOutcome, photo: int) -> str:
    survey = outcome.survey
    if photo in outcome.clean.findings.photos:
        return "its targets contradict the other photographs: another zoom or focus, or plates that were moved"
    for place, network in enumerate(outcome.networks):
        if network.oriented[photo] and place != outcome.chosen:
            return (
                f"it belongs to a part of {describe_part(survey, network)} that shares too few plates with the rest: "
                "photograph what lies between"
            )
    seen = survey.problem.sightings.target[survey.problem.sightings.photo == photo]
    if not len(seen):
        return "each of its targets shows fewer than four dots, or dots on one line"
    shared = int(np.isin(seen, outcome.clean.part.targets).sum())
    if not shared:
        return f"its {len(seen)} targets are in no other oriented photograph: {OVERLAP_ADVICE}"
    return f"its {shared} targets shared with other photographs do not agree on one pose: photograph it again"


def left_out_targets(outcome: SurveyOutcome) -> tuple[LeftOutRecord, ...]:
    """Targets that were seen and are not published, each with its reason, by code."""
    survey = outcome.survey
    found = {
        survey.codes[one.target]: LeftOutRecord(int(survey.codes[one.target]), one.reason, one.detail)
        for one in outcome.clean.findings.targets
    }
    published = outcome.codes[outcome.solution.published]
    rays_seen = survey.problem.sightings.rays()
    for target, code in enumerate(survey.codes):
        if code not in found and code not in published:
            found[code] = _too_weak(outcome, target, int(rays_seen[target]))
    return tuple(found[code] for code in sorted(found))


def _too_weak(outcome: SurveyOutcome, target: int, seen: int) -> LeftOutRecord:
    """Too few photographs agree on the target, or their rays are too nearly parallel."""
    code = int(outcome.survey.codes[target])
    place = np.flatnonzero(outcome.clean.part.targets == target)
    rays = int(outcome.solution.problem.sightings.rays()[place].sum())
    if rays >= outcome.quality.fewest_rays:
        angle_deg = float(np.degrees(outcome.solution.angles_rad[place].max()))
        detail = f"its {rays} rays meet at {angle_deg:.1f} degrees at most: photograph it from places farther apart"
        return LeftOutRecord(code, "angle", detail)
    detail = (
        f"{rays} of the {seen} photographs that show it agree on its place and {outcome.quality.fewest_rays} must: "
        "photograph it again"
    )
    return LeftOutRecord(code, "rays", detail)
