"""The demonstration room on a service: surveyed by a real build, once for all tests of the pages that only read it."""

from __future__ import annotations

import os
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.api.serving import Served, room_control_points, room_photos

if TYPE_CHECKING:
    from collections.abc import Iterator

LONGEST_BUILD_S = 600.0


@dataclass(frozen=True)
class Room:
    """A site with a map, and a trajectory of its snapshots."""

    site_id: str
    survey_id: str
    trajectory_id: str


def surveyed_room(served: Served, folders: pytest.TempPathFactory, *, as_new: bool = False) -> Room:
    """The room, imported from an archive that the first process to come here makes and the others wait for.

    As new it is another site each time: for a test that changes it.
    """
    # Of this run alone: an archive that outlives it is of other code. A run's processes share the folder above theirs.
    base = folders.getbasetemp()
    archive = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "surveyed-room.scattermark"
    with _alone(archive.with_suffix(".lock")):
        if not archive.exists():
            _make_archive(served, archive)
    answer = served.client.post("/sites/import", params={"as_new": as_new}, content=archive.read_bytes(), timeout=120.0)
    assert answer.status_code == 201, answer.text
    site_id = answer.json()["site_id"]
    (survey,) = served.client.get(f"/sites/{site_id}/surveys").json()["surveys"]
    (trajectory,) = served.client.get("/trajectories", params={"site_id": site_id}).json()["trajectories"]
    return Room(site_id, survey["survey_id"], trajectory["trajectory_id"])


def _make_archive(served: Served, archive: Path) -> None:
    site_id = served.new_site(name="Demonstration room")
    assert served.put_control_points(site_id, room_control_points()).status_code == 200
    survey_id = served.new_survey(site_id, note="the demonstration room", device_id="surveyor")
    for name, data in room_photos("survey").items():
        assert served.put_photo(survey_id, name, data).status_code == 201
    assert served.build(survey_id)["state"] == "succeeded"
    opened = served.client.post("/trajectories", json={"site_id": site_id, "device_id": "phone"})
    assert opened.status_code == 201, opened.text
    for second, image in enumerate(room_photos("locate").values()):
        answer = served.locate(
            site_id, image, trajectory_id=opened.json()["trajectory_id"], captured_at=f"2026-05-01T09:00:{second:02}Z"
        )
        assert answer.status_code in (200, 422), answer.text  # one shows no target
    exported = served.client.get(f"/sites/{site_id}/export", timeout=120.0)
    assert exported.status_code == 200, exported.text
    served.client.delete(f"/sites/{site_id}")
    partial = archive.with_suffix(".partial")
    partial.write_bytes(exported.content)
    partial.rename(archive)


@contextmanager
def _alone(lock: Path) -> Iterator[None]:
    """Hold a lock that only one process has at a time."""
    deadline_s = time.monotonic() + LONGEST_BUILD_S
    while True:
        try:
            os.close(os.open(lock, os.O_CREAT | os.O_EXCL))
            break
        except FileExistsError:
            assert time.monotonic() < deadline_s, f"somebody else holds {lock}"
            time.sleep(0.1)
    try:
        yield
    finally:
        lock.unlink()
