"""A wall clock that jumps: nothing that waits, beats or counts may hang on it."""

from __future__ import annotations

import shutil
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from datetime import datetime
from pathlib import Path

import pytest

from app.settings import Settings
from tests.api.serving import Served, room_photos
from tests.faults.installation import Installation
from tests.faults.ledger import Ledger, wait_until

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or shutil.which("gcc") is None, reason="the clock is shifted by a library made with gcc"
)

HOUR_S, DAY_S = 3600, 86_400
SLACK_S = 600  # of the moment at which the clock is read; far less than a jump
FEW = ("IMG_0000.jpg", "IMG_0001.jpg", "IMG_0013.jpg", "IMG_0015.jpg", "IMG_0011.jpg", "IMG_0003.jpg")


class Clock:
    """The wall clock of an installation's processes."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.jump(0)

    def jump(self, shift_s: int) -> None:
        """Let it be so far from the true one from now on."""
        with self._path.open("r+b" if self._path.exists() else "wb", buffering=0) as file:
            file.write(struct.pack("@q", shift_s))


@pytest.fixture(scope="module")
def clock(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Clock]:
    folder = tmp_path_factory.mktemp("clock")
    library = folder / "clock_shift.so"
    source = Path(__file__).with_name("clock_shift.c")
    subprocess.run(["gcc", "-shared", "-fPIC", "-O1", "-o", str(library), str(source)], check=True)
    clock = Clock(folder / "shift")
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("LD_PRELOAD", str(library))
        environment.setenv("CLOCK_SHIFT_FILE", str(folder / "shift"))
        yield clock


@pytest.fixture(scope="module")
def served(clock: Clock, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    clock.jump(0)
    settings = Settings(data_dir=tmp_path_factory.mktemp("installation"), locate_workers=1, build_workers=1)
    with Installation(settings) as installation, installation.serving() as running:
        yield running


@pytest.fixture(scope="module")
def ledger(served: Served) -> Iterator[Ledger]:
    with closing(Ledger(served)) as kept:
        yield kept


@pytest.fixture(autouse=True)
def clock_is_right_again(clock: Clock, ledger: Ledger) -> Iterator[None]:
    """Afterwards, too, nothing may be lost."""
    clock.jump(0)
    yield
    ledger.check()
    clock.jump(0)
    ledger.check()


def told_shift_s(served: Served) -> float:
    return float(served.client.get("/time").json()["server_time_s"]) - time.time()


@pytest.mark.parametrize("shift_s", [-HOUR_S, DAY_S, -40 * 365 * DAY_S], ids=["an hour back", "a day on", "to 1986"])
def test_snapshots_and_photographs_keep_their_order_of_arrival(clock: Clock, ledger: Ledger, shift_s: int) -> None:
    before = ledger.locate().json()
    clock.jump(shift_s)
    assert abs(told_shift_s(ledger.served) - shift_s) < SLACK_S
    after = ledger.locate().json()
    assert after["trajectory_id"] == before["trajectory_id"]
    page = ledger.served.client.get(f"/trajectories/{after['trajectory_id']}", params={"limit": "1000"}).json()
    ordinals = {pose["pose_id"]: pose["ordinal"] for pose in page["poses"]}
    assert ordinals[after["pose_id"]] == ordinals[before["pose_id"]] + 1
    apart = datetime.fromisoformat(after["captured_at"]) - datetime.fromisoformat(before["captured_at"])
    assert abs(apart.total_seconds() - shift_s) < SLACK_S
    assert ledger.upload(f"shifted by {shift_s} s.jpg", room_photos("survey")["IMG_0002.jpg"]).status_code == 201


def test_a_snapshot_of_before_the_jump_is_answered_as_then(clock: Clock, ledger: Ledger) -> None:
    snapshot_id = "6f1c1f6e-0000-4000-8000-00000000000b"
    first = ledger.locate(snapshot_id=snapshot_id).json()
    clock.jump(-DAY_S)
    again = ledger.locate(snapshot_id=snapshot_id).json()
    assert (again["pose_id"], again["captured_at"]) == (first["pose_id"], first["captured_at"])


@pytest.mark.parametrize("shift_s", [-HOUR_S, DAY_S], ids=["an hour back", "a day on"])
def test_a_build_under_way_ends_once_and_well(clock: Clock, ledger: Ledger, shift_s: int) -> None:
    client, site_id = ledger.served.client, ledger.served.new_site()
    survey_id = ledger.served.new_survey(site_id)
    for name in FEW:
        assert ledger.served.put_photo(survey_id, name, room_photos("survey")[name]).status_code == 201
    job_id = client.post(f"/surveys/{survey_id}/build").json()["job_id"]
    wait_until(lambda: client.get(f"/jobs/{job_id}").json()["state"] == "running", "the build does not begin")
    clock.jump(shift_s)
    assert ledger.served.wait(job_id)["state"] == "succeeded"
    assert len(client.get(f"/sites/{site_id}/maps").json()["maps"]) == 1
