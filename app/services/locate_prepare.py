"""What a snapshot's work needs beside its pixels: one question to the database, and cameras that are held meanwhile."""

from __future__ import annotations

import time
from collections import OrderedDict
from dataclasses import dataclass
from functools import partial
from threading import Lock
from typing import Generic, TypeVar

from app.errors import Conflict
from app.geometry.camera import CalibratedCamera
from app.services.capture_time import moment_of
from app.services.choose_camera import KnownCameras
from app.services.locate_request import LocateRequest
from app.storage.cameras import CameraRepository
from app.storage.database import Database
from app.storage.locate_facts import CameraState, LocateFacts, Question, locate_facts
from app.storage.records import Keep, StoredCamera
from app.storage.snapshots import Heading, Snapshot
from app.storage.trajectories import TrajectoryRepository

Key = TypeVar("Key")
Value = TypeVar("Value")

NO_CAMERAS = 0
CAMERAS_HELD = 512  # sites and devices; the handful of cameras of one takes some 10 kB


@dataclass(frozen=True)
class Prepared:
    """All that a snapshot's work needs.

    Attributes
    ----------
    heading : Heading
    cameras : KnownCameras
    keep : Keep
        Which snapshots' pictures the site keeps.
    """

    heading: Heading
    cameras: KnownCameras
    keep: Keep


@dataclass(frozen=True)
class _Stored:
    """The cameras of a site and a device, and the state of the database that they are of."""

    of_site: CameraState
    of_device: CameraState
    cameras: tuple[StoredCamera, ...]


class Preparation:
    """Prepares snapshots; used by several threads."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._stored: _Held[tuple[str, str | None], _Stored] = _Held(CAMERAS_HELD)
        self._named: _Held[str, CalibratedCamera] = _Held(CAMERAS_HELD)

    def prepare(self, request: LocateRequest) -> Prepared | Snapshot:
        """The first answer to a repeat; else all that the work needs, so that a wrong request costs no worker.

        Raises
        ------
        NotFound, Conflict, InvalidInput
            When the request cannot be right.
        """
        received_s = time.time()
        moment = moment_of(request.clock, received_s)
        names = (request.site_id, request.device_id, request.snapshot_id, request.trajectory_id, request.camera_id)
        facts = self._database.look(partial(locate_facts, question=Question(*names)))
        if facts.answered and (first := self._first(request)) is not None:
            return first
        if facts.active_version is None:
            raise Conflict(
                "the site has no target map yet; upload survey photographs and POST /surveys/{survey_id}/build",
                site_id=request.site_id,
            )
        if request.trajectory_id is not None and not facts.takes:
            self._refuse_trajectory(request.trajectory_id, request.site_id)
        heading = Heading(
            request.site_id, facts.active_version, moment, received_s, request.device_id, request.snapshot_id
        )
        return Prepared(heading, self._cameras(request, facts), facts.keep)

    def _first(self, request: LocateRequest) -> Snapshot | None:
        with self._database.reading() as session:
            return TrajectoryRepository(session).find(request.site_id, str(request.snapshot_id))

    def _refuse_trajectory(self, trajectory_id: str, site_id: str) -> None:
        """Say what is wrong with it; it may have become right in this moment."""
        with self._database.reading() as session:
            TrajectoryRepository(session).open_one(trajectory_id, site_id)

    def _cameras(self, request: LocateRequest, facts: LocateFacts) -> KnownCameras:
        named = None if request.camera_id is None else self._camera(request.camera_id, facts)
        # Most devices were never calibrated: all of them share what the site has.
        device_id = None if facts.of_device.count == NO_CAMERAS else request.device_id
        key = request.site_id, device_id
        held = self._stored.get(key)
        if held is None or (held.of_site, held.of_device) != (facts.of_site, facts.of_device):
            with self._database.reading() as session:
                held = _Stored(facts.of_site, facts.of_device, CameraRepository(session).candidates(*key))
            self._stored.put(key, held)
        return KnownCameras(request.device_id, named, request.client_camera, held.cameras)

    def _camera(self, camera_id: str, facts: LocateFacts) -> CalibratedCamera:
        held = self._named.get(camera_id) if facts.camera_there else None
        if held is None:
            with self._database.reading() as session:
                held = CameraRepository(session).get(camera_id).calibrated
            self._named.put(camera_id, held)
        return held


class _Held(Generic[Key, Value]):
    """What was used last, by several threads."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._values: OrderedDict[Key, Value] = OrderedDict()
        self._lock = Lock()

    def get(self, key: Key) -> Value | None:
        """What is held under a key."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
            return self._values.get(key)

    def put(self, key: Key, value: Value) -> None:
        """Hold a value; the one that was not used for longest goes."""
        with self._lock:
            self._values[key] = value
            self._values.move_to_end(key)
            while len(self._values) > self._most:
                self._values.popitem(last=False)
