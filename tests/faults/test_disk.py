"""A disk without room: what cannot be kept is refused, what was kept stays, and with room again all goes on."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from app.settings import Settings
from tests.api.serving import environment_of, room_photos, serve
from tests.faults.ledger import Ledger, wait_until

DISK_MB = 24
ROOM_BYTES = 100_000  # less than a photograph
PHOTOS = list(room_photos("survey").items())

Disk = Path


@pytest.fixture(scope="module")
def disk(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Disk]:
    """A file system of its own that is soon full."""
    place = tmp_path_factory.mktemp("disk")
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={DISK_MB}m", "tmpfs", str(place)], capture_output=True, check=False
    )
    if mounted.returncode:
        pytest.skip(f"no file system can be mounted here: {mounted.stderr.decode().strip()}")
    yield place
    subprocess.run(["umount", "--lazy", str(place)], check=True)


@pytest.fixture(scope="module")
def on_disk(disk: Disk) -> Iterator[Ledger]:
    settings = Settings(data_dir=disk / "data", locate_workers=1, build_workers=1)
    with serve(replace(settings, min_free_bytes=0), worker=False) as running, closing(Ledger(running)) as kept:
        yield kept


@pytest.fixture
def filler(disk: Disk) -> Iterator[Path]:
    """Somebody else's file, which grows."""
    path = disk / "filler"
    yield path
    path.unlink(missing_ok=True)


def fill(filler: Path, room_bytes: int) -> None:
    """Leave so much room."""
    with filler.open("ab", buffering=0) as file:
        free_bytes = os.statvfs(filler).f_bavail * os.statvfs(filler).f_frsize
        os.posix_fallocate(file.fileno(), os.fstat(file.fileno()).st_size, max(1, free_bytes - room_bytes))


def names(ledger: Ledger) -> set[str]:
    answer = ledger.served.client.get(f"/surveys/{ledger.survey_id}/images", params={"limit": "1000"})
    return {image["name"] for image in answer.json()["images"]}


def test_a_photograph_without_room_is_refused_and_leaves_nothing(on_disk: Ledger, filler: Path) -> None:
    fill(filler, ROOM_BYTES)
    before, free_before = names(on_disk), os.statvfs(filler).f_bavail
    answer = on_disk.upload("too-much.jpg", PHOTOS[0][1])
    assert answer.status_code == 507, answer.text
    assert answer.json()["type"].endswith("/insufficient-storage")
    assert names(on_disk) == before
    # What the refused upload wrote is given back.
    wait_until(lambda: os.statvfs(filler).f_bavail >= free_before - 16, "the refused upload holds room")
    filler.unlink()
    assert on_disk.upload("too-much.jpg", PHOTOS[0][1]).status_code == 201
    on_disk.check()


def test_a_form_of_photographs_without_room_for_the_last_leaves_none(on_disk: Ledger, filler: Path) -> None:
    data = [("images", (name, data)) for name, data in PHOTOS[:4]]
    fill(filler, sum(len(part[1][1]) for part in data) - ROOM_BYTES)
    answer = on_disk.served.client.post(f"/surveys/{on_disk.survey_id}/images", files=data)
    assert answer.status_code == 507, answer.text
    assert not names(on_disk) & {name for name, _ in PHOTOS[:4]}
    filler.unlink()
    on_disk.check()


def test_rows_without_room_are_refused_and_the_service_stays_up(on_disk: Ledger, filler: Path) -> None:
    fill(filler, 0)
    statuses = [on_disk.locate().status_code for _ in range(30)]
    # The write-ahead log has some pages left; then it has none.
    assert set(statuses) <= {200, 503, 507}
    assert statuses[-1] in (503, 507)
    made = on_disk.served.client.post("/sites", json={"name": "x" * 200})
    assert made.status_code in (201, 503, 507)
    client = on_disk.served.client
    assert client.get("/healthz").status_code == 200
    assert client.get("/readyz").status_code == 503
    assert client.get(f"/sites/{on_disk.site_id}").status_code == 200
    filler.unlink()
    on_disk.check()


def test_a_backup_without_room_says_so_and_leaves_nothing(on_disk: Ledger, filler: Path, disk: Disk) -> None:
    fill(filler, ROOM_BYTES)
    target = disk / "backup"
    command = [sys.executable, "-m", "app.cli", "backup", str(target)]
    command += ["--data-dir", str(on_disk.served.settings.data_dir)]
    run = subprocess.run(
        command, env=environment_of(on_disk.served.settings), capture_output=True, text=True, check=False
    )
    assert run.returncode != 0
    assert "Traceback" not in run.stderr
    assert "No space left" in run.stderr.splitlines()[-1]
    assert [path for path in disk.iterdir() if path.name.startswith("backup")] == []
    filler.unlink()
    on_disk.check()
