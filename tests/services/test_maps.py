"""A map in its four formats, read back by its reader."""

from __future__ import annotations

import csv
import io
import json

import numpy as np
import pytest

from app.errors import Conflict
from app.geometry.map_file import map_from_json
from app.services import maps
from app.services.maps import PublishedMap
from app.storage.database import Database
from app.storage.records import GeoAnchor
from app.storage.sites import SiteRepository
from app.storage.target_maps import TargetMapRepository
from tests.storage import examples

MICROMETRE = 0.5e-6  # what the text formats round to


@pytest.fixture
def published(database: Database) -> PublishedMap:
    site, survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        TargetMapRepository(session).publish(site.site_id, examples.publication("job-1", survey_id))
        maps.activate_map(session, site.site_id, 1)
        SiteRepository(session).anchor(site.site_id, GeoAnchor(48.15, 11.57, 515.0, 30.0))
    with database.reading() as session:
        return maps.published_map(session, site.site_id, None)


def test_json_is_a_map_file(published: PublishedMap) -> None:
    record = json.loads(json.dumps(maps.json_of_map(published)))
    assert (record["site_id"], record["map_version"]) == (published.site.site_id, 1)
    content = map_from_json(record)
    assert content.target_map.by_code.keys() == published.target_map.by_code.keys()
    (camera,) = content.cameras
    assert camera.identity == examples.IDENTITY


def test_csv_holds_every_target(published: PublishedMap) -> None:
    rows = list(csv.DictReader(io.StringIO(maps.csv_of_map(published))))
    assert [int(row["code"]) for row in rows] == [target.code for target in published.target_map.targets]
    for row, target in zip(rows, published.target_map.targets, strict=True):
        position_m = [float(row[f"{axis}_m"]) for axis in "xyz"]
        np.testing.assert_allclose(position_m, target.site_from_target.position_m, atol=MICROMETRE)
        dot_m = [float(row[f"r2c1_{axis}_m"]) for axis in "xyz"]
        np.testing.assert_allclose(dot_m, target.dots_m[9], atol=MICROMETRE)
        variances_m2 = np.diag(
            target.covariance + published.target_map.datum.pose_covariance(target.site_from_target.position_m)
        )
        np.testing.assert_allclose(float(row["sigma_y_m"]), np.sqrt(variances_m2[1]), atol=MICROMETRE)


def test_ply_holds_every_dot(published: PublishedMap) -> None:
    header, body = maps.ply_of_map(published).split("end_header\n")
    assert header.startswith("ply\nformat ascii 1.0\n")
    vertices = [line.split() for line in body.splitlines()]
    assert f"element vertex {len(vertices)}\n" in header
    assert len(vertices) == 16 * len(published.target_map.targets)
    first = published.target_map.targets[0]
    np.testing.assert_allclose([float(value) for value in vertices[5][:3]], first.dots_m[5], atol=MICROMETRE)
    assert vertices[5][3:] == ["200", "28", "36", str(first.code), "5"]  # base dot E is red
    assert vertices[6][3:6] != ["200", "28", "36"]


def test_geojson_stands_on_the_earth(published: PublishedMap) -> None:
    collection = json.loads(maps.geojson_of_map(published))
    assert collection["type"] == "FeatureCollection"
    for feature, target in zip(collection["features"], published.target_map.targets, strict=True):
        longitude_deg, latitude_deg, height_m = feature["geometry"]["coordinates"]
        assert abs(longitude_deg - 11.57) < 1e-3
        assert abs(latitude_deg - 48.15) < 1e-3
        assert height_m == pytest.approx(515.0 + target.site_from_target.position_m[2])
        assert feature["properties"]["code"] == target.code


def test_geojson_needs_an_anchor(database: Database, published: PublishedMap) -> None:
    with database.writing() as session:
        SiteRepository(session).anchor(published.site.site_id, None)
    with database.reading() as session, pytest.raises(Conflict, match="geo_anchor"):
        maps.geojson_of_map(maps.published_map(session, published.site.site_id, 1))


def test_the_report_names_photographs_that_were_left_out(database: Database, published: PublishedMap) -> None:
    with database.reading() as session:
        report = maps.adjustment_report(session, published.site.site_id, None)
    assert (report["map_version"], report["sigma0"]) == (1, 0.97)
    assert report["photographs_left_out"] == [
        {"name": "b.jpg", "reason": "sees no target that another photograph sees"}
    ]
