"""What must hold after any fault: nothing lost that was acknowledged, nothing half-written, the service up."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable
from typing import Any

import httpx
import numpy as np
from sqlalchemy import func, select, text

from app.storage.database import Database, Session
from app.storage.models import PhotographRow, SnapshotRow, TrajectoryRow
from app.storage.photo_store import open_photo_store
from tests.api.serving import Served, room_photos
from tests.faults.true_room import true_position_m, true_room

SNAPSHOT = "IMG_0000.jpg"
SNAPSHOT_BYTES = room_photos("locate")[SNAPSHOT]
NEAR_M = 0.05  # the camera is known from EXIF only
RECOVERY_S = 240.0  # of a machine with ten others' work to do; recovery itself takes a second or two
POLL_S = 0.02


class Ledger:
    """Keeps what a service acknowledged, to be held against it after a fault."""

    def __init__(self, served: Served) -> None:
        self.served = served
        self.database = Database(served.settings.sqlalchemy_url)
        self.site_id = true_room(served, self.database)
        self.survey_id = served.new_survey(self.site_id)
        self._photos: dict[str, str] = {}  # digest by name
        self._poses: dict[str, str] = {}  # trajectory by pose

    def note_photo(self, answer: httpx.Response) -> httpx.Response:
        """An upload's answer; a refusal acknowledges nothing."""
        if answer.is_success:
            photo = answer.json()
            self._photos[photo["name"]] = photo["sha256"]
        return answer

    def note_pose(self, answer: httpx.Response) -> httpx.Response:
        """A snapshot's answer; the failures that are kept name their row as well."""
        body = answer.json()
        if "pose_id" in body:
            self._poses[body["pose_id"]] = body["trajectory_id"]
        return answer

    def upload(self, name: str, data: bytes) -> httpx.Response:
        """Upload a photograph by a connection of its own, and note what is acknowledged."""
        url = self.served.client.base_url.join(f"/surveys/{self.survey_id}/images/{name}")
        return self.note_photo(httpx.put(url, content=data, timeout=RECOVERY_S))

    def locate(self, data: bytes = SNAPSHOT_BYTES, **query: str) -> httpx.Response:
        """Locate a snapshot by a connection of its own, and note what is acknowledged."""
        url = self.served.client.base_url.join("/locate")
        parameters = {"site_id": self.site_id, **query}
        return self.note_pose(httpx.post(url, params=parameters, content=data, timeout=RECOVERY_S))

    def check(self) -> None:
        """Hold the service to all that it acknowledged."""
        self._check_up()
        with self.database.reading() as session:
            check_rows(session)
            check_photographs(session, self.served)
        self._check_acknowledged()

    def close(self) -> None:
        """Let go of the database."""
        self.database.close()

    def _check_up(self) -> None:
        client = self.served.client
        assert client.get("/healthz").status_code == 200
        wait_until(lambda: client.get("/readyz").status_code == 200, "the service is not ready again")
        located = self.locate()
        assert located.status_code == 200, located.text
        assert np.linalg.norm(located.json()["position_m"] - true_position_m(SNAPSHOT)) < NEAR_M

    def _check_acknowledged(self) -> None:
        client = self.served.client
        listed = _all_of(client, f"/surveys/{self.survey_id}/images", "images")
        assert self._photos.items() <= {photo["name"]: photo["sha256"] for photo in listed}.items()
        for trajectory_id in set(self._poses.values()):
            poses = _all_of(client, f"/trajectories/{trajectory_id}", "poses", "failures")
            recorded = {pose["pose_id"] for pose in poses}
            assert {pose for pose, place in self._poses.items() if place == trajectory_id} <= recorded


def check_rows(session: Session) -> None:
    """The database is whole, and its rows agree with each other."""
    if session.get_bind().dialect.name == "sqlite":
        assert session.execute(text("PRAGMA integrity_check")).scalars().all() == ["ok"]
        assert session.execute(text("PRAGMA foreign_key_check")).all() == []
    counted = select(func.count()).where(SnapshotRow.trajectory_id == TrajectoryRow.id).scalar_subquery()
    for ordinal, count in session.execute(select(TrajectoryRow.snapshot_count, counted)):
        assert ordinal == count, "a trajectory counts its snapshots"


def check_photographs(session: Session, served: Served) -> None:
    """Every photograph of every survey is in the store, whole; of what did not arrive nothing is left."""
    folder = served.settings.photographs_dir
    store = open_photo_store(str(folder))
    for sha256 in session.scalars(select(PhotographRow.sha256).distinct()):
        assert hashlib.sha256(store.read(sha256)).hexdigest() == sha256
    wait_until(lambda: not list((folder / "incoming").iterdir()), "something is left of an upload that broke off")


def wait_until(holds: Callable[[], bool], otherwise: str) -> None:
    """Wait for a condition."""
    deadline_s = time.monotonic() + RECOVERY_S
    while not holds():
        assert time.monotonic() < deadline_s, otherwise
        time.sleep(POLL_S)


def _all_of(client: httpx.Client, path: str, *lists: str) -> list[dict[str, Any]]:
    """The items of all pages."""
    items: list[dict[str, Any]] = []
    cursor: dict[str, str] = {}
    while True:
        page = client.get(path, params={"limit": "1000", **cursor}).json()
        items.extend(item for name in lists for item in page[name])
        if page["next_cursor"] is None:
            return items
        cursor = {"cursor": page["next_cursor"]}


def rows_of(ledger: Ledger, *entities: Any) -> int:
    """How many rows there are of some tables."""
    with ledger.database.reading() as session:
        return sum(session.scalar(select(func.count()).select_from(entity)) or 0 for entity in entities)
