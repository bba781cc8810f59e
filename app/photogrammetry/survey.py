"""The survey, from what was seen in unordered photographs to a target map: the story of one adjustment.

Read the survey, grow networks, choose one, clean it, refer it to the site, say how well it is known, publish.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

from threadpoolctl import threadpool_limits

from app.geometry.control import ControlPoint
from app.geometry.target_map import TargetMap
from app.photogrammetry.choose_network import choose_network
from app.photogrammetry.cleaning import clean_network
from app.photogrammetry.control import check_control
from app.photogrammetry.growth import Growth, GrowthOptions
from app.photogrammetry.initial_network import grow_networks
from app.photogrammetry.quality import QualityOptions, standing_targets
from app.photogrammetry.self_calibration import self_calibrate
from app.photogrammetry.site_network import SiteOptions, refer_to_site
from app.photogrammetry.survey_input import PlateSpec, SurveyInput, SurveyPhoto, read_survey
from app.photogrammetry.survey_outcome import SurveyOutcome
from app.photogrammetry.survey_refusals import check_published, left_out_targets, unoriented_photos
from app.photogrammetry.survey_report import write_report
from app.photogrammetry.survey_result import AdjustedPhoto, SurveyCamera, SurveyResult, adjusted_photos, mapped_targets
from app.photogrammetry.survey_solution import solve_uncertainty

__all__ = [
    "AdjustedPhoto",
    "PlateSpec",
    "SurveyCamera",
    "SurveyOptions",
    "SurveyPhoto",
    "SurveyProgress",
    "SurveyResult",
    "adjust_survey",
]

SurveyProgress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class SurveyOptions:
    """The decisions of each stage."""

    growth: GrowthOptions = field(default_factory=GrowthOptions)
    quality: QualityOptions = field(default_factory=QualityOptions)
    site: SiteOptions = field(default_factory=SiteOptions)


def adjust_survey(
    photos: Sequence[SurveyPhoto],
    control: Sequence[ControlPoint],
    plate: PlateSpec,
    options: SurveyOptions | None = None,
    progress: SurveyProgress | None = None,
) -> SurveyResult:
    """Target map, cameras and poses of unordered photographs.

    Parameters
    ----------
    photos : sequence of SurveyPhoto
        Names unique; several cameras may take part.
    control : sequence of ControlPoint
        Control and check points. Without control points scale and orientation are assumed, and the map says so.
    plate : PlateSpec
    options : SurveyOptions, optional
    progress : callable, optional
        Told the stage (``network``, ``adjust``, ``control``, ``covariance``) with what is done of how much, before
        each step; may raise ``Cancelled``, which leaves nothing behind.

    Returns
    -------
    SurveyResult
        With at least one published target.

    Raises
    ------
    SurveyFailed
        When the photographs give no map; ``fields['reason']`` is a stable slug and the text says what to do.
    InvalidControlPoints
        When control points are too few, in one line, not seen, or contradict the photographs.
    """
    check_control(control)
    survey = read_survey(photos, plate)
    # Thousands of products of small matrices: several threads would only wait for each other.
    with threadpool_limits(limits=1, user_api="blas"):
        return _result(_adjusted(survey, tuple(control), options or SurveyOptions(), progress or _silent), plate)


def _adjusted(
    survey: SurveyInput, points: tuple[ControlPoint, ...], options: SurveyOptions, tell: SurveyProgress
) -> SurveyOutcome:
    networks = _grown(survey, options, tell)
    chosen = choose_network(survey, networks, points)
    clean = clean_network(networks[chosen], options.quality, partial(tell, "adjust", 0, 1))
    codes = survey.codes[clean.part.targets]
    standing = standing_targets(codes, clean.adjusted.network, clean.problem.sightings, options.quality)
    check_published(survey, standing)
    tell("control", 0, 1)
    site = refer_to_site(clean, points, standing, options.site, partial(tell, "control", 0, 1))
    tell("covariance", 0, 1)
    solution = solve_uncertainty(site, standing.published)
    stages = survey, networks, chosen, clean, standing, site, solution
    return SurveyOutcome(*stages, points, options.quality)


def _silent(stage: str, done: int, total: int) -> None:
    """Nobody wants to know."""


def _grown(survey: SurveyInput, options: SurveyOptions, tell: SurveyProgress) -> tuple[Growth, ...]:
    total = len(survey.names)
    tell("network", 0, total)
    return grow_networks(survey.problem, options.growth, lambda oriented: tell("network", oriented, total))


def _result(outcome: SurveyOutcome, plate: PlateSpec) -> SurveyResult:
    survey, solution = outcome.survey, outcome.solution
    targets = mapped_targets(solution, outcome.codes)
    calibrations = self_calibrate(solution.problem, solution.network, solution.border_covariance)
    cameras = tuple(
        SurveyCamera(identity, camera.calibrated)
        for identity, camera in zip(survey.identities, calibrations, strict=True)
        if camera.photographs
    )
    unoriented = unoriented_photos(outcome)
    return SurveyResult(
        TargetMap(targets, solution.datum, plate.code_family, plate.u_m),
        cameras,
        adjusted_photos(solution, outcome.names, survey.identities, outcome.codes),
        tuple((photo.name, photo.reason) for photo in unoriented),
        write_report(outcome, calibrations, unoriented, left_out_targets(outcome)),
    )
