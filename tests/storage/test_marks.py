"""Marks by photograph: replaced as a whole, gone with their survey."""

from __future__ import annotations

import numpy as np

from app.geometry.marks import Mark
from app.storage.database import Database
from app.storage.marks import MarkRepository, every_mark
from app.storage.sites import SiteRepository
from tests.storage import examples


def told(marks: tuple[Mark, ...]) -> list[tuple[object, ...]]:
    return [(mark.code, mark.cell, *mark.position_px.tolist(), mark.sigma_px) for mark in marks]


def test_marks_are_replaced_by_photograph_and_go_with_the_site(database: Database) -> None:
    site, survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        marks = MarkRepository(session)
        marks.replace(survey_id, "a.jpg", [Mark(694, 2, np.array([1.5, 2.0])), Mark(389, 9, np.array([3.0, 4.0]), 0.2)])
        marks.replace(survey_id, "b.jpg", [Mark(389, 0, np.array([5.0, 6.0]))])
    with database.writing() as session:
        marks = MarkRepository(session)
        assert told(marks.of_photo(survey_id, "a.jpg")) == [(389, 9, 3.0, 4.0, 0.2), (694, 2, 1.5, 2.0, 0.5)]
        assert set(marks.of_survey(survey_id)) == {"a.jpg", "b.jpg"}
        marks.replace(survey_id, "a.jpg", [Mark(389, 9, np.array([7.0, 8.0]))])
        assert told(marks.of_photo(survey_id, "a.jpg")) == [(389, 9, 7.0, 8.0, 0.5)]
        marks.replace(survey_id, "b.jpg", [])
        assert marks.of_photo(survey_id, "b.jpg") == ()
        assert len(list(every_mark(session))) == 1
    with database.writing() as session:
        SiteRepository(session).delete(site.site_id)
    with database.reading() as session:
        assert list(every_mark(session)) == []
