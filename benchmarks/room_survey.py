"""A room surveyed and located by the library, with time and memory: what the scores are computed from."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from app.cli.locate_photo import known_cameras, resect_in_map
from app.cli.progress import Report
from app.cli.read_photo import read_photo
from app.cli.room import Room
from app.cli.survey_files import read_control
from app.errors import NotLocated
from app.geometry.control import ControlPoint
from app.geometry.map_file import MapCamera, MapFile
from app.photogrammetry.survey import PlateSpec, SurveyPhoto, SurveyResult, adjust_survey
from app.targets.family import family_by_name
from app.vision.detectors import DetectorName, choose_detector
from benchmarks.memory import peak_rss_bytes
from benchmarks.pose_score import EstimatedPose


@dataclass(frozen=True)
class Surveyed:
    """An adjusted survey and what it took."""

    survey: SurveyResult
    control: tuple[ControlPoint, ...]
    adjust_s: float
    peak_bytes: int

    @property
    def content(self) -> MapFile:
        """Map and cameras as a resection takes them."""
        cameras = tuple(MapCamera(camera.identity, camera.calibrated) for camera in self.survey.cameras)
        return MapFile(self.survey.target_map, cameras)


@dataclass(frozen=True)
class LocatedRoom:
    """What became of the snapshots."""

    poses: tuple[EstimatedPose, ...]
    refused: tuple[tuple[str, str], ...]


def survey_room(room: Room, photos: Sequence[SurveyPhoto], family_name: str, report: Report) -> Surveyed:
    """Adjust the survey of a room from its detections."""
    control = read_control(room.control_points, family_name)
    began_s = time.perf_counter()
    survey = adjust_survey(photos, control, PlateSpec(family_name, room.plate_u_m), progress=report)
    return Surveyed(survey, control, time.perf_counter() - began_s, peak_rss_bytes())


def locate_room(paths: Sequence[Path], content: MapFile, detector: DetectorName, report: Report) -> LocatedRoom:
    """Locate each snapshot with the cameras of the survey."""
    target_map, known = content.target_map, known_cameras(content)
    reader = choose_detector(detector, known_codes=frozenset(target_map.by_code))
    poses, refused = [], []
    for done, path in enumerate(paths, start=1):
        photo = read_photo(path)
        detection = reader.detect(photo.bgr, family_by_name(target_map.code_family))
        try:
            resection = resect_in_map(photo, detection, content, known).resection
            poses.append(EstimatedPose(path.name, resection.site_from_cam, resection.covariance))
        except NotLocated as refusal:
            refused.append((path.name, str(refusal.fields["reason"])))
        report("locating", done, len(paths))
    return LocatedRoom(tuple(poses), tuple(refused))
