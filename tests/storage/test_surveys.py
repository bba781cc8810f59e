from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import Conflict, NotFound
from app.storage.database import Database
from app.storage.paging import PageRequest
from app.storage.surveys import DetectionKey, DetectionRepository, SurveyRepository
from tests.storage import examples

KEY = DetectionKey("a" * 64, "plate-1", "b" * 64)


def test_a_survey_and_its_photographs_come_back(database: Database) -> None:
    site, survey_id = examples.site_with_survey(database)
    photos = [examples.photo("b.jpg", "b" * 64), examples.photo("a.jpg")]
    with database.writing() as session:
        assert all(SurveyRepository(session).add_photo(survey_id, photo) for photo in photos)
    with database.reading() as session:
        surveys = SurveyRepository(session)
        survey = surveys.get(survey_id)
        assert (survey.site_id, survey.note, survey.device_id) == (site.site_id, "first", "phone-1")
        assert surveys.page(site.site_id, PageRequest()).items == (survey,)
        assert surveys.photos(survey_id) == tuple(sorted(photos, key=lambda photo: photo.name))
        assert surveys.photo_count(survey_id) == 2
        first = surveys.photo_page(survey_id, PageRequest(1))
        second = surveys.photo_page(survey_id, PageRequest(1, first.next_cursor))
        assert [photo.name for photo in first.items + second.items] == ["a.jpg", "b.jpg"]
        assert second.next_cursor is None


def test_the_same_bytes_again_change_nothing_and_others_are_refused(database: Database) -> None:
    _, survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        surveys = SurveyRepository(session)
        assert surveys.add_photo(survey_id, examples.photo())
        assert not surveys.add_photo(survey_id, examples.photo())
        with pytest.raises(Conflict, match=r"another photograph named a\.jpg"):
            surveys.add_photo(survey_id, examples.photo(sha256="c" * 64))
        assert surveys.photos(survey_id) == (examples.photo(),)


def test_whatever_a_camera_writes_as_its_time_is_kept(database: Database) -> None:
    _, survey_id = examples.site_with_survey(database)
    photo = replace(examples.photo(), captured_at="2026:05:01 " * 100)
    with database.writing() as session:
        SurveyRepository(session).add_photo(survey_id, photo)
    with database.reading() as session:
        assert SurveyRepository(session).photos(survey_id) == (photo,)


def test_an_unknown_survey_or_site_is_said_so(database: Database) -> None:
    with database.writing() as session:
        with pytest.raises(NotFound, match="no survey"):
            SurveyRepository(session).photo_page("nowhere", PageRequest())
        with pytest.raises(NotFound, match="no site"):
            SurveyRepository(session).add("nowhere", "", None)


def test_a_detection_is_kept_once_under_its_key(database: Database) -> None:
    with database.writing() as session:
        detections = DetectionRepository(session)
        assert detections.get(KEY) is None
        detections.put(KEY, examples.detection())
        detections.put(KEY, examples.detection())
    with database.reading() as session:
        kept = DetectionRepository(session).get(KEY)
    assert kept is not None
    np.testing.assert_array_equal(kept.targets[0].centres_px, examples.detection().targets[0].centres_px)


def test_only_what_was_never_detected_with_these_settings_is_missing(database: Database) -> None:
    others = (
        DetectionKey("c" * 64, KEY.detector, KEY.options_digest),
        DetectionKey(KEY.sha256, "plate-2", KEY.options_digest),
        DetectionKey(KEY.sha256, KEY.detector, "d" * 64),
    )
    with database.writing() as session:
        detections = DetectionRepository(session)
        detections.put(KEY, examples.detection())
        assert detections.missing([KEY, *others, others[0]]) == others
        many = [DetectionKey(f"{index:064d}", "plate-1", "b" * 64) for index in range(1100)]
        assert detections.missing([*many, KEY]) == tuple(many)
