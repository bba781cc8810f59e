"""One survey of a synthetic building from observations to the published map, with time and memory of each stage."""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.cli.report_file import write_report_file
from app.photogrammetry.survey import PlateSpec, SurveyResult, adjust_survey
from app.services.photo_results import photo_results
from app.storage.database import Database
from app.storage.migrate import upgrade
from app.storage.records import NewCamera, Origin, Publication
from app.storage.sites import SiteRepository
from app.storage.surveys import SurveyRepository
from app.storage.target_maps import TargetMapRepository
from app.targets.layout import dots_target_m
from benchmarks.building import FAMILY, Building, BuildingOptions, build_building
from benchmarks.building_views import U_M, ViewOptions, photograph, spread_control
from benchmarks.map_score import MapScore, score_map
from benchmarks.memory import peak_rss_bytes

Array = npt.NDArray[np.float64]

CONTROL_SIGMA_M = 0.001
PHOTOS_PER_CONTROL = 100  # a control point, and a check point, for so many photographs
FEWEST_CONTROL = 4
STAGES = ("network", "adjust", "control", "covariance", "publish", "html", "pdf")

# Photographs to the building that takes them, two plates to a photograph.
BUILDINGS = {
    54: BuildingOptions(wings=1, bays=1, cross_plates=20, cross_photos=6),
    500: BuildingOptions(wings=3, bays=3, cross_plates=136, cross_photos=68),
    1500: BuildingOptions(wings=3, bays=10, cross_plates=120, cross_photos=60),
    5000: BuildingOptions(wings=4, bays=25, cross_plates=400, cross_photos=200),
}


@dataclass(frozen=True)
class SurveyRun:
    """What a survey took and gave.

    Attributes
    ----------
    photos, plates, sightings : int
        Of the building.
    oriented, targets : int
        Photographs with a pose and targets published.
    named : int
        False sightings, and targets left out as moved or deformed, of which there are none.
    cpu_s : dict of str to float
        Of each stage.
    adjust_cpu_s : float
        From observations to the map and its report's records.
    idle_bytes, peak_bytes : int
        Greatest memory of the process before and after.
    score : MapScore
    """

    photos: int
    plates: int
    sightings: int
    oriented: int
    targets: int
    named: int
    cpu_s: dict[str, float]
    adjust_cpu_s: float
    idle_bytes: int
    peak_bytes: int
    score: MapScore


class StageClock:
    """CPU seconds by stage: each lasts until the next one begins."""

    def __init__(self) -> None:
        self.cpu_s: dict[str, float] = {}
        self._stage, self._began_s = "read", time.process_time()

    def enter(self, stage: str, done: int = 0, total: int = 0) -> None:  # noqa: ARG002 - a survey tells counts, too
        """End the present stage and begin another."""
        now_s = time.process_time()
        self.cpu_s[self._stage] = self.cpu_s.get(self._stage, 0.0) + now_s - self._began_s
        self._stage, self._began_s = stage, now_s


def run_survey(photos: int, seed: int) -> SurveyRun:
    """Survey the building of so many photographs."""
    idle_bytes = peak_rss_bytes()
    building = build_building(BUILDINGS[photos], seed)
    seen = photograph(building, ViewOptions(), seed)
    count = max(FEWEST_CONTROL, photos // PHOTOS_PER_CONTROL)
    control = spread_control(building, (count, count), CONTROL_SIGMA_M, seed)
    clock = StageClock()
    result = adjust_survey(seen, control, PlateSpec(FAMILY, U_M), progress=clock.enter)
    clock.enter("publish")
    adjust_cpu_s = sum(clock.cpu_s.values())
    with tempfile.TemporaryDirectory() as folder:
        map_path = Path(folder) / "map.db"
        _publish(result, map_path)
        for kind in ("html", "pdf"):
            clock.enter(kind)
            write_report_file(Path(folder) / f"report.{kind}", result, map_path, "building")
    clock.enter("end")
    return SurveyRun(
        photos=len(seen),
        plates=len(building.plates),
        sightings=sum(len(photo.detection.targets) for photo in seen),
        oriented=len(result.photos),
        targets=len(result.target_map.targets),
        named=named_faults(result),
        cpu_s=clock.cpu_s,
        adjust_cpu_s=adjust_cpu_s,
        idle_bytes=idle_bytes,
        peak_bytes=peak_rss_bytes(),
        score=score_map(result.target_map, true_dots_m(building), control),
    )


def named_faults(result: SurveyResult) -> int:
    """False sightings, and targets left out for what they are rather than for how they were seen."""
    left_out = sum(record.reason not in ("rays", "angle") for record in result.report.left_out)
    return left_out + len(result.report.false_sightings)


def true_dots_m(building: Building) -> dict[int, Array]:
    """Dots of every plate in the site, shape (16, 3) each."""
    return {code: pose.apply(dots_target_m(U_M)) for code, pose in building.plates.items()}


def _publish(result: SurveyResult, path: Path) -> None:
    """Write the map into an embedded database of its own."""
    database = Database(f"sqlite:///{path}")
    upgrade(database)
    with database.writing() as session:
        site = SiteRepository(session).add("building", FAMILY, U_M, None)
        survey = SurveyRepository(session).add(site.site_id, "", None)
        cameras = tuple(NewCamera(camera.identity, camera.calibrated, None) for camera in result.cameras)
        origin = Origin(survey.survey_id, survey.survey_id)
        records = photo_results(result), result.report.to_json()
        TargetMapRepository(session).publish(site.site_id, Publication(result.target_map, origin, cameras, *records))
    database.close()
