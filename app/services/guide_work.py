"""What a worker process does for a survey's guidance: gather what was detected, see what is lacking."""

from __future__ import annotations

from dataclasses import dataclass

from app.photogrammetry.hand_marks import with_marks
from app.photogrammetry.survey_guidance import Guidance, guide_survey
from app.photogrammetry.survey_input import PlateSpec, SurveyPhoto
from app.services.detect_work import DetectSettings
from app.services.workbench import workbench
from app.storage.marks import MarkRepository
from app.storage.sites import SiteRepository
from app.storage.surveys import DetectionRepository, SurveyRepository


@dataclass(frozen=True)
class GuideTask:
    """A survey whose photographs have been looked at, with these settings."""

    survey_id: str
    settings: DetectSettings


def guide(task: GuideTask) -> Guidance:
    """What a survey lacks, by all of its photographs that were detected so far.

    Raises
    ------
    NotFound
        When there is no such survey.
    """
    with workbench().database.reading() as session:
        surveys, detections = SurveyRepository(session), DetectionRepository(session)
        site = SiteRepository(session).get(surveys.get(task.survey_id).site_id)
        points = SiteRepository(session).control_points(site.site_id)
        marks = MarkRepository(session).of_survey(task.survey_id)
        photos = []
        for photo in surveys.photos(task.survey_id):
            detection = detections.get(task.settings.key(photo.sha256))
            if detection is not None:
                seen = with_marks(detection, marks.get(photo.name, ()))
                photos.append(SurveyPhoto(photo.name, photo.identity, seen))
    return guide_survey(photos, points, PlateSpec(site.code_family, site.plate_u_m))
