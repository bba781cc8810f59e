"""What a survey still lacks while it is photographed: targets with too few rays, too narrow ones, and where to shoot.

    detections -> rays of each target -> quick network -> angles -> viewpoints

The network is the initial one, without the final adjustment: good to centimetres, enough to say where to stand.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
from threadpoolctl import threadpool_limits

from app.errors import SurveyFailed
from app.geometry.control import ControlPoint
from app.geometry.similarity import estimate_similarity
from app.photogrammetry.control import FEWEST_POINTS, StandingTargets, is_one_line, match_points
from app.photogrammetry.growth import Growth, GrowthOptions
from app.photogrammetry.initial_network import grow_networks
from app.photogrammetry.network import Network
from app.photogrammetry.quality import QualityOptions
from app.photogrammetry.survey_input import PlateSpec, SurveyInput, SurveyPhoto, read_survey
from app.photogrammetry.viewpoints import Shot, Viewed, Viewpoints

Array = npt.NDArray[np.float64]
Frame = Literal["site", "model", "none"]
TargetState = Literal["good", "few-rays", "narrow", "apart", "unseen"]


@dataclass(frozen=True)
class GuidedTarget:
    """What one target of a survey has and lacks.

    Attributes
    ----------
    code : int
    state : str
        ``good``; ``few-rays``: too few photographs show it; ``narrow``: they stand too near to each other; ``apart``:
        they do not hang together with the others; ``unseen``: it carries a control point and no photograph shows it.
    rays : int
        Photographs that show it.
    angle_rad : float or None
        Greatest angle between two of its rays; None when the target or its photographs have no place yet.
    control : bool
        Whether it carries a control or check point.
    companions : tuple of int
        Targets to photograph together with it, those that stand nearest first.
    shot : Shot or None
        From where to photograph it next; None when it is good, or has no place yet.
    """

    code: int
    state: TargetState
    rays: int
    angle_rad: float | None
    control: bool
    companions: tuple[int, ...] = ()
    shot: Shot | None = None


@dataclass(frozen=True)
class NextShot:
    """The photograph that helps most targets at once, and which."""

    shot: Shot
    codes: tuple[int, ...]


@dataclass(frozen=True)
class Guidance:
    """What a survey has and lacks.

    Attributes
    ----------
    photographs, oriented : int
        Photographs that were looked at, and those that hang together.
    frame : str
        Of the places: ``site`` once three control points stand, ``model`` before, ``none`` without a network.
    fewest_rays, least_angle_rad : int, float
        What a target needs.
    targets : tuple of GuidedTarget
        Codes ascending.
    loose : tuple of str
        Photographs with targets that do not hang together with the others.
    next_shot : NextShot or None
        None when nothing is lacking, or no place is known.
    trouble : str
        Why there is no network yet; empty when there is one.
    """

    photographs: int
    oriented: int
    frame: Frame
    fewest_rays: int
    least_angle_rad: float
    targets: tuple[GuidedTarget, ...]
    loose: tuple[str, ...]
    next_shot: NextShot | None
    trouble: str = ""

    @property
    def lacking(self) -> tuple[GuidedTarget, ...]:
        """Targets that a build would leave out now."""
        return tuple(target for target in self.targets if target.state != "good")


@dataclass(frozen=True)
class GuidanceOptions:
    """How guidance is given.

    Attributes
    ----------
    companions : int
        Targets to be photographed together with one, at the most: two others tie a photograph to the network, a third
        outvotes one that is misread.
    growth : GrowthOptions
    quality : QualityOptions
        What a target needs to be published.
    """

    companions: int = 3
    growth: GrowthOptions = GrowthOptions()
    quality: QualityOptions = QualityOptions()


@dataclass(frozen=True)
class _Standing:
    """A network with the names of its photographs and the codes of its targets; which of them stand."""

    survey: SurveyInput
    growth: Growth
    network: Network
    frame: Frame

    def viewed(self) -> dict[int, Viewed]:
        """The targets that stand, with the photographs that stand and see them, by code."""
        sightings, growth = self.growth.problem.sightings, self.growth
        found = {}
        for target in np.flatnonzero(growth.placed).tolist():
            photos = sightings.photo[sightings.target == target]
            photos = photos[growth.oriented[photos]]
            found[int(self.survey.codes[target])] = Viewed(
                self.network.target_rotations[target],
                self.network.target_positions_m[target],
                self.network.photo_positions_m[photos],
                tuple(self.survey.names[photo] for photo in photos.tolist()),
            )
        return found


def guide_survey(
    photos: Sequence[SurveyPhoto],
    points: Sequence[ControlPoint],
    plate: PlateSpec,
    options: GuidanceOptions | None = None,
) -> Guidance:
    """What the photographs so far have and lack.

    Parameters
    ----------
    photos : sequence of SurveyPhoto
        Names unique; none or one will do.
    points : sequence of ControlPoint
        Control and check points, if there are any yet.
    plate : PlateSpec
    options : GuidanceOptions, optional
    """
    options = options or GuidanceOptions()
    with threadpool_limits(limits=1, user_api="blas"):
        try:
            survey = read_survey(photos, plate)
            standing, trouble = _largest(survey, points, plate, options)
        except SurveyFailed as failure:  # too early for a network: rays can be counted all the same
            standing, trouble = None, failure.detail
    viewed = {} if standing is None else standing.viewed()
    guide = _Guide(photos, points, viewed, "none" if standing is None else standing.frame, options)
    targets = tuple(guide.target(code) for code in guide.codes)
    oriented = set() if standing is None else _oriented(standing)
    return Guidance(
        photographs=len(photos),
        oriented=len(oriented),
        frame=guide.frame,
        fewest_rays=options.quality.fewest_rays,
        least_angle_rad=options.quality.least_angle_rad,
        targets=targets,
        loose=tuple(photo.name for photo in photos if photo.detection.targets and photo.name not in oriented),
        next_shot=_best_shot(targets, viewed),
        trouble=trouble,
    )


class _Guide:
    """Judges targets."""

    def __init__(
        self,
        photos: Sequence[SurveyPhoto],
        points: Sequence[ControlPoint],
        viewed: dict[int, Viewed],
        frame: Frame,
        options: GuidanceOptions,
    ) -> None:
        self._seen = [{target.code for target in photo.detection.targets} for photo in photos]
        self._rays = Counter(code for codes in self._seen for code in codes)
        self._control = {point.code for point in points}
        self._viewed = viewed
        self._options = options
        stations = {
            name: eye_m for seen in viewed.values() for name, eye_m in zip(seen.names, seen.eyes_m, strict=True)
        }
        stations_m = np.array(list(stations.values())).reshape(-1, 3)
        self._viewpoints = Viewpoints(frame == "site", stations_m, tuple(stations))
        self.frame = frame

    @property
    def codes(self) -> list[int]:
        """All that is seen or should be, ascending."""
        return sorted({*self._rays, *self._control})

    def target(self, code: int) -> GuidedTarget:
        """What one target has and lacks."""
        viewed, rays = self._viewed.get(code), self._rays[code]
        angle_rad = None if viewed is None else viewed.angle_rad
        state = self._state(code, rays, angle_rad)
        if state == "good":
            return GuidedTarget(code, state, rays, angle_rad, code in self._control)
        shot = None if viewed is None or not viewed.names else self._viewpoints.shot(viewed)
        return GuidedTarget(code, state, rays, angle_rad, code in self._control, self._companions(code), shot)

    def _state(self, code: int, rays: int, angle_rad: float | None) -> TargetState:
        quality = self._options.quality
        if rays == 0:
            return "unseen"
        if rays < quality.fewest_rays:
            return "few-rays"
        if angle_rad is None or len(self._viewed[code].names) < quality.fewest_rays:
            return "apart"
        return "good" if angle_rad >= quality.least_angle_rad else "narrow"

    def _companions(self, code: int) -> tuple[int, ...]:
        """Targets near to one that stand, or, where nothing stands, those that are seen with it most often."""
        here = self._viewed.get(code)
        if here is not None:
            away_m = {
                other: float(np.linalg.norm(there.position_m - here.position_m))
                for other, there in self._viewed.items()
                if other != code and there.normal @ here.normal > 0
            }
            return tuple(sorted(away_m, key=lambda other: away_m[other])[: self._options.companions])
        beside = Counter(other for codes in self._seen if code in codes for other in codes if other != code)
        return tuple(other for other, _ in beside.most_common(self._options.companions))


def _largest(
    survey: SurveyInput, points: Sequence[ControlPoint], plate: PlateSpec, options: GuidanceOptions
) -> tuple[_Standing | None, str]:
    """The network of most photographs, in the site's frame when three control points stand in it."""
    networks = grow_networks(survey.problem, options.growth, lambda _oriented: None)
    if not networks:
        return None, "No two photographs share enough plates to stand together: let each show several of another's."
    growth = max(networks, key=lambda network: int(network.oriented.sum()))
    placed = StandingTargets(survey.codes, growth.placed, growth.placed)
    control = match_points(points, "control", placed, plate.u_m).equations
    if len(control) < FEWEST_POINTS or is_one_line(control.position_m, control.sigma_m):
        return _Standing(survey, growth, growth.network, "model"), ""
    site_from_model = estimate_similarity(control.computed_m(growth.network), control.position_m)
    return _Standing(survey, growth, growth.network.transformed(site_from_model), "site"), ""


def _oriented(standing: _Standing) -> set[str]:
    return {standing.survey.names[photo] for photo in np.flatnonzero(standing.growth.oriented).tolist()}


def _best_shot(targets: Sequence[GuidedTarget], viewed: dict[int, Viewed]) -> NextShot | None:
    """Of the shots that single targets ask for, the one that helps most of all that lack something."""
    lacking = [target.code for target in targets if target.state != "good" and target.code in viewed]
    best: NextShot | None = None
    for target in targets:
        if target.shot is None:
            continue
        helped = tuple(code for code in lacking if target.shot.helps(viewed[code]))
        if best is None or len(helped) > len(best.codes):
            best = NextShot(target.shot, helped)
    return best
