from __future__ import annotations

from pathlib import Path

import pytest

from app.errors import NotFound
from app.services import workbench as workbench_module
from app.services.workbench import Workbench
from app.storage.database import Database
from app.storage.photo_store import open_photo_store
from app.storage.target_maps import TargetMapRepository
from tests.storage import examples


def test_maps_are_read_once_and_the_oldest_go_first(
    database: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workbench_module, "MAPS_HELD", 2)
    site, survey_id = examples.site_with_survey(database)
    for number in (1, 2, 3):
        with database.writing() as session:
            TargetMapRepository(session).publish(
                site.site_id, examples.publication(f"job-{number}", survey_id, (388 + number,))
            )
    bench = Workbench(database, open_photo_store(str(tmp_path / "photographs")))
    first = bench.target_map(site.site_id, 1)
    assert bench.target_map(site.site_id, 1) is first
    assert list(bench.target_map(site.site_id, 2).by_code) == [390]
    assert bench.target_map(site.site_id, 1) is first  # used again, so the second is now the oldest
    bench.target_map(site.site_id, 3)
    assert bench.target_map(site.site_id, 1) is first
    with pytest.raises(NotFound):
        bench.target_map(site.site_id, 4)


def test_a_process_without_its_bench_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workbench_module._Process, "workbench", None)
    with pytest.raises(RuntimeError, match="open_workbench"):
        workbench_module.workbench()
