"""Surveys to report on: a good one, and one with everything that can go wrong and names that attack their readers."""

from __future__ import annotations

from dataclasses import replace

from app.photogrammetry.report import ControlRecord, FalseSightingRecord, LeftOutRecord
from app.photogrammetry.survey import SurveyResult, adjust_survey
from app.services.build_options import Exclusion
from app.services.photo_results import photo_results
from app.services.survey_report.material import Extended, Fingerprint, Heading, ReportMaterial
from app.storage.records import PhotoResult
from tests.photogrammetry.survey_scene import (
    CHECK_DOTS,
    CONTROL_DOTS,
    PLATE,
    build_room,
    control_points,
    ring_of_stations,
    survey_photos,
)
from tests.services.reporting.names import HOSTILE

ROOM = build_room()
STATIONS = ring_of_stations(16)
SLIP_M = 0.05  # a check point that was measured on another dot


def heading(site_name: str = "Hall 3") -> Heading:
    fingerprint = Fingerprint("targets?format=csv&version=7", "0123456789abcdef" * 4)
    return Heading(
        site_name, "site-1", "survey-1", 7, "first survey", 1777627800.0, 1777631400.0, "Scattermark 0", fingerprint
    )


def good_survey() -> SurveyResult:
    points = control_points(ROOM, CONTROL_DOTS, noise_m=0.001)
    points += control_points(ROOM, CHECK_DOTS, noise_m=0.001, role="check", seed=5)
    return adjust_survey(survey_photos(ROOM, STATIONS), points, PLATE)


def material_of(survey: SurveyResult, **more: object) -> ReportMaterial:
    return ReportMaterial(heading(), survey.report, survey.target_map, photo_results(survey), **more)  # type: ignore[arg-type]


def faulty_material(survey: SurveyResult) -> ReportMaterial:
    """The same survey as if all had gone wrong that can, with names of the worst kind and a second camera."""
    report = survey.report
    (camera,), (residuals,) = report.cameras, report.image_residuals
    other = replace(camera, key=HOSTILE[9])
    photos = tuple(
        replace(photo, name=_named(photo.name, number), camera=(camera, other)[number % 2].key)
        for number, photo in enumerate(report.photos)
    )
    faulty = replace(
        report,
        converged=False,
        cameras=(camera, other),
        image_residuals=(residuals, residuals),
        photos=photos,
        control=_faulty_points(report.control),
        left_out=(
            LeftOutRecord(106, "moved", "stands in two places 0.200 m apart: it was moved or is posted twice"),
            LeftOutRecord(123, "deformed", "is bent: its dots stand 1.7 mm off a plane; fix it flat"),
            LeftOutRecord(700, "rays", f"2 of 2 photographs agree: photograph it again {HOSTILE[8]}"),
            LeftOutRecord(701, "angle", "its 3 rays meet at 2.0 degrees at most: photograph it from farther apart"),
        ),
        false_sightings=(FalseSightingRecord(photos[4].name, 104, 469.7),),
        warnings=(f"The map would fit as well with names exchanged ({HOSTILE[2]}).",),
    )
    results = [replace(result, name=photo.name) for result, photo in zip(photo_results(survey), photos, strict=True)]
    return ReportMaterial(
        replace(heading(HOSTILE[0]), survey_note=HOSTILE[6]),
        faulty,
        survey.target_map,
        (*results, PhotoResult(name=HOSTILE[1], reason=HOSTILE[5])),
        Exclusion((HOSTILE[2],), (389,), (HOSTILE[3],)),
        Extended(6, (101, 102), (103,)),
    )


def _named(name: str, number: int) -> str:
    return f"{number} {HOSTILE[number]}" if number < len(HOSTILE) else name


def _faulty_points(control: tuple[ControlRecord, ...]) -> tuple[ControlRecord, ...]:
    """A check point far off, one named to be run, one on a target that nobody saw."""
    *others, doubtful, named, unseen = control
    assert doubtful.residual_m is not None
    slipped = replace(doubtful, residual_m=doubtful.residual_m + SLIP_M)
    return (*others, slipped, replace(named, name=HOSTILE[4]), replace(unseen, name=HOSTILE[10], residual_m=None))
