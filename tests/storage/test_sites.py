from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import NotFound
from app.geometry.control import ControlPoint
from app.storage.database import Database
from app.storage.models import Base
from app.storage.paging import PageRequest
from app.storage.records import GeoAnchor, Site
from app.storage.sites import SiteRepository
from app.storage.surveys import SurveyRepository
from app.storage.target_maps import TargetMapRepository
from app.storage.trajectories import TrajectoryRepository
from tests.storage import examples

ANCHOR = GeoAnchor(48.1, 11.5, 520.0, -30.0)
POINTS = (
    ControlPoint("CP2", 389, "A", np.array([1.5, -2.25, 0.125]), 0.001, "control"),
    ControlPoint("CP1", 389, "centre", np.array([1e-9, 2.0, 3.0]), 0.002, "check"),
)


def same_points(mine: tuple[ControlPoint, ...], theirs: tuple[ControlPoint, ...]) -> bool:
    return [repr(point) for point in mine] == [repr(point) for point in theirs]


def test_a_site_comes_back_as_it_was_made(database: Database) -> None:
    with database.writing() as session:
        made = SiteRepository(session).add("Halle 3", "golay", 0.02, ANCHOR)
    with database.reading() as session:
        assert SiteRepository(session).get(made.site_id) == made
    assert made.geo_anchor == ANCHOR
    assert made.active_version is None


def test_a_site_can_be_renamed_and_anchored(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        sites = SiteRepository(session)
        sites.rename(site.site_id, "hall")
        sites.anchor(site.site_id, ANCHOR)
    with database.writing() as session:
        assert SiteRepository(session).get(site.site_id) == replace(site, name="hall", geo_anchor=ANCHOR)
        SiteRepository(session).anchor(site.site_id, None)
    with database.reading() as session:
        assert SiteRepository(session).get(site.site_id).geo_anchor is None


def test_pages_follow_each_other_without_gap_or_repeat(database: Database) -> None:
    with database.writing() as session:
        made = [SiteRepository(session).add(f"site {index}", "golay", 0.014, None) for index in range(5)]
    found: list[Site] = []
    cursor = None
    with database.reading() as session:
        while True:
            page = SiteRepository(session).page(PageRequest(2, cursor))
            found += page.items
            cursor = page.next_cursor
            if cursor is None:
                break
    assert {site.site_id for site in found} == {site.site_id for site in made}
    assert len(found) == len(made)


def test_control_points_are_replaced_as_a_whole_and_keep_their_order(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    for points in (POINTS, POINTS[:1], ()):
        with database.writing() as session:
            SiteRepository(session).replace_control_points(site.site_id, points)
        with database.reading() as session:
            assert same_points(SiteRepository(session).control_points(site.site_id), points)


def test_an_unknown_site_is_said_so(database: Database) -> None:
    with database.reading() as session, pytest.raises(NotFound, match="no site nowhere"):
        SiteRepository(session).get("nowhere")


def test_a_removed_site_leaves_no_row_behind(database: Database) -> None:
    site, survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        SiteRepository(session).replace_control_points(site.site_id, POINTS)
        SurveyRepository(session).add_photo(survey_id, examples.photo())
        TargetMapRepository(session).publish(site.site_id, examples.publication("job-1", survey_id))
        trajectory = TrajectoryRepository(session).default(site.site_id, "phone-1")
        TrajectoryRepository(session).record(trajectory.trajectory_id, examples.snapshot(site, examples.located()))
    with database.writing() as session:
        SiteRepository(session).delete(site.site_id)
    with database.reading() as session:
        left = {name: session.query(table).count() for name, table in Base.metadata.tables.items()}
    assert left == dict.fromkeys(Base.metadata.tables, 0)
