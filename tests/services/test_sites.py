from __future__ import annotations

import pytest

from app.errors import Conflict, InvalidInput, NotFound
from app.services.sites import NewSite, SiteChange, change_site, create_site, delete_site
from app.storage.database import Database
from app.storage.jobs import JobRepository
from app.storage.records import GeoAnchor
from tests.storage.examples import site_with_survey

ANCHOR = GeoAnchor(48.15, 11.57)


def test_a_site_takes_a_family_that_exists(database: Database) -> None:
    with database.writing() as session:
        assert create_site(session, NewSite("room", "golay", 0.014, ANCHOR)).geo_anchor == ANCHOR
        with pytest.raises(InvalidInput, match="colay"):
            create_site(session, NewSite("room", "colay", 0.014))


def test_only_what_is_named_changes(database: Database) -> None:
    site, _ = site_with_survey(database)
    with database.writing() as session:
        assert change_site(session, site.site_id, SiteChange(name="hall")).name == "hall"
        anchored = change_site(session, site.site_id, SiteChange(set_anchor=True, geo_anchor=ANCHOR))
        assert (anchored.name, anchored.geo_anchor) == ("hall", ANCHOR)
        assert change_site(session, site.site_id, SiteChange(name="room")).geo_anchor == ANCHOR
        assert change_site(session, site.site_id, SiteChange(set_anchor=True)).geo_anchor is None


def test_a_site_is_not_removed_under_a_running_build(database: Database) -> None:
    site, survey_id = site_with_survey(database)
    with database.writing() as session:
        job = JobRepository(session).add("build", site.site_id, survey_id, {})
    with pytest.raises(Conflict, match=job.job_id), database.writing() as session:
        delete_site(session, site.site_id)
    with database.writing() as session:
        JobRepository(session).cancel(job.job_id)
    with database.writing() as session:
        delete_site(session, site.site_id)
    with pytest.raises(NotFound), database.writing() as session:
        delete_site(session, site.site_id)
