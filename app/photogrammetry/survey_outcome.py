"""All that the stages of a survey found, gathered for those who write about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.control import ControlPoint
from app.photogrammetry.cleaning import CleanNetwork
from app.photogrammetry.control import StandingTargets
from app.photogrammetry.growth import Growth
from app.photogrammetry.quality import QualityOptions
from app.photogrammetry.site_network import SiteNetwork
from app.photogrammetry.survey_input import SurveyInput
from app.photogrammetry.survey_solution import Solution


@dataclass(frozen=True)
class SurveyOutcome:
    """The stages of one survey.

    Attributes
    ----------
    survey : SurveyInput
    networks : tuple of Growth
        All that the photographs form.
    chosen : int
        Which of them is published.
    clean : CleanNetwork
    standing : StandingTargets
    site : SiteNetwork
    solution : Solution
    points : tuple of ControlPoint
        Control and check points as given.
    quality : QualityOptions
    """

    survey: SurveyInput
    networks: tuple[Growth, ...]
    chosen: int
    clean: CleanNetwork
    standing: StandingTargets
    site: SiteNetwork
    solution: Solution
    points: tuple[ControlPoint, ...]
    quality: QualityOptions

    @property
    def codes(self) -> npt.NDArray[np.intp]:
        """Codes of the chosen network's targets, shape (T,)."""
        return self.standing.codes

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the chosen network's photographs."""
        return tuple(self.survey.names[photo] for photo in self.clean.part.photos)
