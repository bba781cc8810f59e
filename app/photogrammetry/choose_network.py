"""Of the networks that the photographs form, the one to publish: the one with the control points, or the largest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.errors import SurveyFailed
from app.geometry.control import ControlPoint
from app.photogrammetry.control import FEWEST_POINTS
from app.photogrammetry.growth import Growth
from app.photogrammetry.survey_input import OVERLAP_ADVICE, SurveyInput


def choose_network(survey: SurveyInput, networks: Sequence[Growth], points: Sequence[ControlPoint]) -> int:
    """Place of the network to publish.

    Raises
    ------
    SurveyFailed
        Reason ``no-overlap`` when no two photographs hang together, ``control-in-parts`` when the control points are
        spread over parts none of which has three.
    """
    if not networks:
        raise SurveyFailed(
            f"No two of the {len(survey.names)} photographs share enough plates to stand together: {OVERLAP_ADVICE}.",
            reason="no-overlap",
            photos=list(survey.names),
        )
    codes = np.array([point.code for point in points if point.role == "control"])
    held = [int(np.isin(codes, survey.codes[network.decided]).sum()) for network in networks]
    sizes = [int(network.oriented.sum()) for network in networks]
    best = max(range(len(networks)), key=lambda part: (min(held[part], FEWEST_POINTS), sizes[part]))
    if held[best] < FEWEST_POINTS <= sum(held):
        parts = "; ".join(describe_part(survey, network) for network in networks)
        raise SurveyFailed(
            f"The photographs form {len(networks)} parts that share too few plates, and none holds three control "
            f"points: {parts}. Add photographs that show plates of two parts at once.",
            reason="control-in-parts",
            parts=[[survey.names[photo] for photo in np.flatnonzero(network.oriented)] for network in networks],
        )
    return best


def describe_part(survey: SurveyInput, network: Growth) -> str:
    """A part in words: how many photographs, from which to which."""
    names = sorted(survey.names[photo] for photo in np.flatnonzero(network.oriented))
    return f"{len(names)} photographs ({names[0]} ... {names[-1]})"
