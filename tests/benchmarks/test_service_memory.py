"""The line through a memory; and a real service whose memory does not grow with the requests that it has answered."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.storage.database import Database
from app.storage.migrate import upgrade
from app.storage.target_maps import TargetMapRepository
from benchmarks.service_clients import Load, drive
from benchmarks.service_memory import growth, memory_over
from benchmarks.service_process import BYTES_PER_MB, Memory, own_service
from tests.api.serving import ROOM
from tests.storage import examples

PHOTO = ROOM / "locate" / "IMG_0000.jpg"
REQUESTS, ROUNDS = 400, 20


def test_the_line_of_a_memory_that_grows_is_found() -> None:
    samples = [(100 * number, Memory(50.0, 200.0 + 0.5 * number)) for number in range(1, 21)]
    assert growth(samples, lambda memory: memory.api_mb).slope_mb_per_1000 == pytest.approx(0.0, abs=1e-9)
    line = growth(samples, lambda memory: memory.worker_mb)
    assert line.slope_mb_per_1000 == pytest.approx(5.0)
    assert (line.first_mb, line.last_mb) == (203.0, 210.0)  # the first quarter does not count


def test_the_memory_of_a_service_stays_flat(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'scattermark.db'}")
    upgrade(database)
    site, survey_id = examples.site_with_survey(database)
    with database.writing() as session:
        maps = TargetMapRepository(session)
        maps.activate(site.site_id, maps.publish(site.site_id, examples.publication("job", survey_id)))
    database.close()
    one_worker = {"SCATTERMARK_LOCATE_WORKERS": "1"}
    with own_service(tmp_path, one_worker, worker=False) as address:

        def ask(count: int) -> None:
            answered = drive(Load(address.port, site.site_id, str(PHOTO), False, 4, count))
            assert set(answered.statuses) <= {"200", "422"}  # the map has other targets than the photograph

        samples = memory_over(address.pid, ask, REQUESTS, ROUNDS)
    # Whoever forgot to let go of requests would hold a photograph of each; of half of them is a leak, less is noise.
    photo_mb_per_1000 = 1000 * PHOTO.stat().st_size / BYTES_PER_MB
    for of in (lambda memory: memory.api_mb, lambda memory: memory.worker_mb):
        assert growth(samples, of).slope_mb_per_1000 < photo_mb_per_1000 / 2
