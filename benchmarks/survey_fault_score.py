"""What a survey's report says of the faults that were put into it, and what they did to the rest of the map."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from app.errors import InvalidControlPoints
from app.photogrammetry.survey import PlateSpec, SurveyResult, adjust_survey
from benchmarks.building import FAMILY, BuildingOptions, build_building
from benchmarks.building_views import U_M, ViewOptions, photograph, spread_control
from benchmarks.survey_faults import FAULTS, Faulty, Sound

# Two layouts: rooms and a corridor; a bare corridor, which is long and thin.
LAYOUTS = {
    "rooms": BuildingOptions(wings=1, bays=2),
    "corridor": BuildingOptions(wings=0, cross_plates=120, cross_photos=80, lone_corridor_m=30.0),
}
CONTROL_POINTS, CHECK_POINTS, CONTROL_SIGMA_M = 6, 2, 0.001


@dataclass(frozen=True)
class FaultScore:
    """Counts over all faults of a kind.

    Attributes
    ----------
    kind : str
    faults : int
        That were put in.
    detected : int
        That did no harm or are named: false sightings that take no part, targets that are not published or are known
        to be of another print batch, photographs
        that have no pose or have lost what is false, control that is refused.
    named : int
        Of these, with the right reason or among the suspects.
    false_alarms : int
        Sound sightings and targets called wrong, and photographs without a pose that have one otherwise.
    lost : int
        Sound targets that are not published though they are without the fault.
    effects : tuple of float
        Of each survey the root mean square step of the other targets, in their sigmas.
    """

    kind: str
    faults: int
    detected: int
    named: int
    false_alarms: int
    lost: int
    effects: tuple[float, ...] = field(default=())


def score_faults(seeds: range, only: str = "") -> Iterator[FaultScore]:
    """Every kind of fault whose name holds a text, in every layout and building."""
    sounds = [_sound(options, seed) for options in LAYOUTS.values() for seed in seeds]
    clean = [_adjusted(Faulty(sound.photos, sound.control)) for sound in sounds]
    sounds = [_with_detectable(*pair) for pair in zip(sounds, clean, strict=True)]
    for kind, spoil in FAULTS.items():
        if only not in kind:
            continue
        scores = []
        for sound, result in zip(sounds, clean, strict=True):
            assert isinstance(result, SurveyResult)
            faulty = spoil(sound, np.random.default_rng(sound.seed))
            scores.append(_score(kind, faulty, _adjusted(faulty), result))
        yield _summed(scores)


def _sound(options: BuildingOptions, seed: int) -> Sound:
    building = build_building(options, seed)
    photos = photograph(building, ViewOptions(), seed)
    control = spread_control(building, (CONTROL_POINTS, CHECK_POINTS), CONTROL_SIGMA_M, seed)
    return Sound(options, building, photos, control, seed)


def _with_detectable(sound: Sound, result: SurveyResult | InvalidControlPoints) -> Sound:
    assert isinstance(result, SurveyResult)
    known = {target.code: target.detectable_m for target in result.report.targets}
    return replace(sound, detectable_m={code: least_m for code, least_m in known.items() if least_m is not None})


def _adjusted(faulty: Faulty) -> SurveyResult | InvalidControlPoints:
    try:
        return adjust_survey(faulty.photos, faulty.control, PlateSpec(FAMILY, U_M))
    except InvalidControlPoints as error:
        return error


def _summed(scores: list[FaultScore]) -> FaultScore:
    return FaultScore(
        scores[0].kind,
        faults=sum(score.faults for score in scores),
        detected=sum(score.detected for score in scores),
        named=sum(score.named for score in scores),
        false_alarms=sum(score.false_alarms for score in scores),
        lost=sum(score.lost for score in scores),
        effects=tuple(effect for score in scores for effect in score.effects),
    )


def _score(kind: str, faulty: Faulty, result: SurveyResult | InvalidControlPoints, clean: SurveyResult) -> FaultScore:
    if isinstance(result, InvalidControlPoints):
        suspects = [set(one["points"]) for one in result.fields.get("suspects", [])]
        right = set(faulty.points) in suspects[:1]
        return FaultScore(kind, faulty.count, len(faulty.points), len(faulty.points) * right, int(not faulty.points), 0)
    said = _Said(result)
    detected = sum(said.is_out(*sighting) for sighting in faulty.sightings)
    detected += sum(code not in said.published or code in said.resized for code in faulty.targets)
    detected += sum(said.knows_photo(name) for name in faulty.bad_photos)
    named = sum(said.names_sighting(*sighting) for sighting in faulty.sightings)
    named += sum(said.reasons.get(code) == faulty.reason or code in said.resized for code in faulty.targets)
    named += sum(said.knows_photo(name) for name in faulty.bad_photos)
    alarms = sum(
        sighting not in faulty.sightings and sighting[0] not in faulty.bad_photos and sighting[1] not in faulty.targets
        for sighting in said.false
    )
    alarms += sum(
        reason not in ("rays", "angle") and code not in faulty.targets for code, reason in said.reasons.items()
    )
    alarms += len(said.resized - faulty.targets)
    before = {name for name, _ in clean.unoriented}
    alarms += sum(name not in before and name not in faulty.bad_photos for name in said.unoriented)
    others = clean.target_map.by_code.keys() - faulty.targets
    lost = len(others - said.published)
    return FaultScore(kind, faulty.count, detected, named, alarms, lost, (_effect(result, clean, others),))


class _Said:
    """What a report says."""

    def __init__(self, result: SurveyResult) -> None:
        self.published = set(result.target_map.by_code)
        self.reasons = {record.code: record.reason for record in result.report.left_out}
        self.false = {(record.photo, record.code) for record in result.report.false_sightings}
        batches = (batch.codes for batch in result.report.print_batches if batch.found)
        self.resized = {code for codes in batches for code in codes}
        self.unoriented = {name for name, _ in result.unoriented}

    def is_out(self, photo: str, code: int) -> bool:
        """Whether a false sighting has no part in the map."""
        return self.names_sighting(photo, code) or code not in self.published

    def names_sighting(self, photo: str, code: int) -> bool:
        """Whether a false sighting, or its whole photograph, is called wrong."""
        return (photo, code) in self.false or photo in self.unoriented

    def knows_photo(self, name: str) -> bool:
        """Whether a wrong photograph has no pose, or false sightings."""
        return name in self.unoriented or any(photo == name for photo, _ in self.false)


def _effect(result: SurveyResult, clean: SurveyResult, codes: set[int]) -> float:
    """Root mean square step of targets against the survey without faults, in sigmas per coordinate."""
    squares = []
    for code in codes & result.target_map.by_code.keys():
        new, old = result.target_map.by_code[code], clean.target_map.by_code[code]
        step_m = new.site_from_target.position_m - old.site_from_target.position_m
        squares.append(step_m @ np.linalg.solve(old.covariance[:3, :3], step_m) / len(step_m))
    return float(np.sqrt(np.mean(squares)))
