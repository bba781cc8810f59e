from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator

import numpy as np
import pytest

from app.errors import Conflict, NotFound
from app.services.geodesy import geodetic
from app.services.trajectory_export import trajectory_text
from app.storage import pose_reading
from app.storage.database import Database
from app.storage.records import GeoAnchor
from app.storage.sites import SiteRepository
from app.storage.trajectory_parts import TimeRange
from tests.storage.walks import START_S, Step, add_walk, new_site

ANCHOR = GeoAnchor(48.15, 11.57, 515.0, 30.0)
# Every fourth a failure; two at each time.
STEPS = tuple(Step(number // 2, (float(number), 2.0, 1.5) if number % 4 else None) for number in range(20))
POSE_X_M = [float(number) for number in range(20) if number % 4]
SECOND_HALF = TimeRange(START_S + 5.0, START_S + 10.0)


@pytest.fixture(autouse=True)
def several_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pose_reading, "POSES_AT_A_TIME", 5)  # 15 poses are three whole parts


def test_all_poses_are_written_in_each_format(database: Database) -> None:
    site_id = new_site(database)
    trajectory_id = add_walk(database, site_id, STEPS)
    with database.writing() as session:
        SiteRepository(session).anchor(site_id, ANCHOR)
    tum = np.loadtxt(io.StringIO(joined(trajectory_text(database, trajectory_id, "tum", TimeRange()))))
    np.testing.assert_array_equal(tum[:, 1], POSE_X_M)
    half = np.loadtxt(io.StringIO(joined(trajectory_text(database, trajectory_id, "tum", SECOND_HALF))))
    np.testing.assert_array_equal(half[:, 1], [x_m for x_m in POSE_X_M if x_m >= 10.0])
    rows = list(csv.DictReader(io.StringIO(joined(trajectory_text(database, trajectory_id, "csv", TimeRange())))))
    assert [float(row["x_m"]) for row in rows] == POSE_X_M
    collection = json.loads(joined(trajectory_text(database, trajectory_id, "geojson", TimeRange())))
    assert (collection["site_id"], collection["trajectory_id"]) == (site_id, trajectory_id)
    last = collection["features"][-1]["geometry"]["coordinates"]
    np.testing.assert_allclose(last[:2], geodetic(np.array([19.0, 2.0, 1.5]), ANCHOR)[:2], rtol=0, atol=1e-9)
    assert last[2] == 516.5


def test_what_cannot_be_written_is_said_before_the_first_piece(database: Database) -> None:
    trajectory_id = add_walk(database, new_site(database), ())
    with pytest.raises(Conflict, match="geo-anchor"):
        trajectory_text(database, trajectory_id, "geojson", TimeRange())
    with pytest.raises(NotFound, match="no trajectory"):
        trajectory_text(database, "nowhere", "csv", TimeRange())
    assert joined(trajectory_text(database, trajectory_id, "tum", TimeRange())) == ""


def joined(pieces: Iterator[str]) -> str:
    return "".join(pieces)
