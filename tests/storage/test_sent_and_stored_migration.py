"""Photographs that came before sent and stored were told apart are known by the same digest for both."""

from __future__ import annotations

from dataclasses import replace

from app.storage.database import Database
from app.storage.migrate import downgrade, upgrade
from app.storage.records import Keep, KeepingPolicy
from app.storage.sites import SiteRepository
from app.storage.surveys import SurveyRepository
from tests.storage.examples import photo, site_with_survey


def test_what_was_stored_was_sent(database: Database) -> None:
    site, survey_id = site_with_survey(database)
    kept = photo("a.jpg", "ab" * 32)
    with database.writing() as session:
        SurveyRepository(session).add_photo(survey_id, kept)
        SiteRepository(session).keep(site.site_id, KeepingPolicy(Keep.ALL, 60.0))
    downgrade(database, "0005")
    upgrade(database)
    with database.reading() as session:
        (found,) = SurveyRepository(session).photos(survey_id)
        assert SiteRepository(session).get(site.site_id).keeping == KeepingPolicy()
    assert found == replace(kept, sent_sha256=kept.sha256, sent_bytes=kept.size_bytes)
