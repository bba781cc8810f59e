"""Every code family from printed plates to a pose: photographs -> detect -> adjust_survey -> resect."""

from __future__ import annotations

import numpy as np
import pytest

from app.photogrammetry.resection import resect
from app.photogrammetry.survey import PlateSpec, SurveyPhoto, SurveyResult, adjust_survey
from app.targets.family import FAMILY_NAMES, family_by_name
from app.vision.detector import detect
from app.vision.photo import load_photo
from tests.family_rooms import U_M, FamilyRoom, family_room

GROSS_SIGMAS = 5.0  # of the position's own covariance: what lies farther off was not measured but mistaken


def survey_of(room: FamilyRoom, name: str) -> SurveyResult:
    photos = []
    for file_name, rendered in room.photos.items():
        photo = load_photo(rendered.jpeg)
        photos.append(SurveyPhoto(file_name, photo.identity, detect(photo.bgr, family_by_name(name))))
    return adjust_survey(photos, room.plan.control, PlateSpec(name, U_M))


@pytest.mark.parametrize("name", FAMILY_NAMES)
def test_a_site_can_use_any_family(name: str) -> None:
    room = family_room(name)
    survey = survey_of(room, name)
    assert survey.unoriented == ()
    assert survey.target_map.code_family == name
    published = set(survey.target_map.by_code)
    assert room.carried <= published <= room.codes
    snapshot = load_photo(room.snapshot.jpeg)
    known = frozenset(published)
    detection = detect(snapshot.bgr, family_by_name(name), known_codes=known)
    pose = resect(detection.targets, survey.target_map, survey.cameras[0].calibrated)
    assert {target.code for target in pose.targets if target.used} >= room.snapshot.whole_codes() & known
    error_m = pose.site_from_cam.position_m - room.site_from_cam.position_m
    assert (np.abs(error_m) < GROSS_SIGMAS * np.sqrt(np.diag(pose.covariance)[:3])).all()
