"""A published map's report, read from the database as it was written there."""

from __future__ import annotations

from dataclasses import replace
from hashlib import sha256

import pytest

from app.errors import Conflict, NotFound
from app.photogrammetry.survey import SurveyResult
from app.services.build_options import Exclusion
from app.services.maps import csv_of_map, published_map
from app.services.photo_results import photo_results
from app.services.survey_report.compose import compose
from app.services.survey_report.gather import gather
from app.services.survey_report.material import Extended
from app.storage.database import Database
from app.storage.records import Origin, PhotoResult, Publication
from app.storage.target_maps import TargetMapRepository
from tests.services.reporting.texts import table_of
from tests.services.survey_report.scene import material_of
from tests.storage import examples

WRITTEN_S = 1777631400.0


@pytest.fixture
def site_id(database: Database, survey: SurveyResult) -> str:
    """A site with a plain version, an extended one, and one of a release that kept less."""
    site, survey_id = examples.site_with_survey(database)
    lost = PhotoResult(name="lost.jpg", reason="not a JPEG")
    report = survey.report.to_json()
    plain = Publication(
        survey.target_map, Origin(survey_id, "job-1"), (), (*photo_results(survey), lost), {**report, "excluded": {}}
    )
    told = {
        "excluded": {"images": ["a.jpg"], "codes": [389], "control_points": ["P1"]},
        "extension": {"base_version": 1, "added": [101], "moved": [102, 103]},
    }
    extended = replace(plain, origin=Origin(survey_id, "job-2", 1), report={**report, **told})
    with database.writing() as session:
        maps = TargetMapRepository(session)
        for publication in (plain, extended, examples.publication("job-3", survey_id)):
            maps.publish(site.site_id, publication)
        maps.activate(site.site_id, 1)
    return site.site_id


def test_the_active_version_is_told_as_it_was_adjusted(database: Database, site_id: str, survey: SurveyResult) -> None:
    with database.reading() as session:
        material = gather(session, site_id, None, WRITTEN_S)
        csv = csv_of_map(published_map(session, site_id, 1))
    assert material.heading.map_version == 1
    assert (material.heading.site_name, material.heading.survey_note) == ("room", "first")
    assert material.heading.written_s == WRITTEN_S
    assert material.heading.fingerprint.of == "targets?format=csv&version=1"
    assert material.heading.fingerprint.sha256 == sha256(csv.encode()).hexdigest()
    assert [photo.name for photo in material.unoriented] == ["lost.jpg"]
    assert material.extended is None
    title = "Poses of the targets"
    assert table_of(compose(material), title) == table_of(compose(material_of(survey)), title)


def test_what_a_build_left_out_and_extended_is_told(database: Database, site_id: str) -> None:
    with database.reading() as session:
        material = gather(session, site_id, 2, WRITTEN_S)
    assert material.excluded == Exclusion(("a.jpg",), (389,), ("P1",))
    assert material.extended == Extended(1, (101,), (102, 103))


def test_a_record_that_kept_less_is_refused_with_advice(database: Database, site_id: str) -> None:
    with database.reading() as session, pytest.raises(Conflict, match="format=json"):
        gather(session, site_id, 3, WRITTEN_S)


def test_what_does_not_exist_is_not_found(database: Database, site_id: str) -> None:
    with database.reading() as session:
        with pytest.raises(NotFound):
            gather(session, site_id, 9, WRITTEN_S)
        with pytest.raises(NotFound):
            gather(session, "nowhere", None, WRITTEN_S)
