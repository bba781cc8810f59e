"""Maps are there before they are needed, each read once, and what is in use is never pushed out."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.services import read_ahead as read_ahead_module
from app.services import workbench as workbench_module
from app.services.read_ahead import ReadAhead
from app.services.workbench import Workbench
from app.storage.database import Database
from app.storage.photo_store import open_photo_store
from app.storage.target_maps import TargetMapRepository
from tests.storage import examples


@pytest.fixture
def bench(sqlite_database: Database, tmp_path: Path) -> Workbench:
    return Workbench(sqlite_database, open_photo_store(str(tmp_path / "photographs")))


def published(database: Database, place: tuple[str, str], job_id: str, *, activate: bool = True) -> tuple[str, int]:
    """A further map of a site; the site and its version."""
    site_id, survey_id = place
    with database.writing() as session:
        maps = TargetMapRepository(session)
        version = maps.publish(site_id, examples.publication(job_id, survey_id))
        if activate:
            maps.activate(site_id, version)
    return site_id, version


def new_place(database: Database) -> tuple[str, str]:
    site, survey_id = examples.site_with_survey(database)
    return site.site_id, survey_id


def test_active_and_newest_versions_are_read(bench: Workbench) -> None:
    place = new_place(bench.database)
    new_place(bench.database)  # without a map
    first = published(bench.database, place, "one")
    ahead = ReadAhead(bench)
    ahead.look()
    assert bench.held() == {first}
    second = published(bench.database, place, "two", activate=False)
    ahead.look()
    assert bench.held() == {first, second}  # ready to be activated, and the first still is what snapshots began with


def test_each_version_is_read_once(bench: Workbench, monkeypatch: pytest.MonkeyPatch) -> None:
    published(bench.database, new_place(bench.database), "one")
    ahead = ReadAhead(bench)
    ahead.look()
    monkeypatch.setattr(bench, "target_map", lambda *_key: pytest.fail("read again"))
    ahead.look()


def test_what_is_in_use_is_not_pushed_out(bench: Workbench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workbench_module, "MAPS_HELD", 2)
    monkeypatch.setattr(read_ahead_module, "MAPS_HELD", 2)
    used = [published(bench.database, new_place(bench.database), f"used {number}") for number in range(2)]
    for key in used:
        bench.target_map(*key)
    for number in range(3):
        published(bench.database, new_place(bench.database), f"other {number}")
    ReadAhead(bench).look()
    assert bench.held() == set(used)


def test_without_a_database_nothing_is_read_and_nothing_breaks(tmp_path: Path) -> None:
    nowhere = Database(f"sqlite:///{tmp_path / 'no folder' / 'none.db'}")
    ReadAhead(Workbench(nowhere, open_photo_store(str(tmp_path / "photographs")))).look_or_tell()
