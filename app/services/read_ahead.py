"""Target maps are read before the first snapshot needs them: when a worker starts, and soon after they are published.

A version is read as soon as it is there, active or not: activating it then costs nobody anything. Work in progress goes
on with the version it began with, which stays held.
"""

from __future__ import annotations

import logging
import threading

from app.errors import NotFound, OutOfSpace, StorageUnavailable
from app.services.workbench import MAPS_HELD, Workbench
from app.storage.target_maps import newest_versions

log = logging.getLogger(__name__)

INTERVAL_S = 0.5  # a look takes some 0.3 ms of a worker's time; from publication to activation by hand it takes seconds


class ReadAhead:
    """Reads maps for one workbench, each once: what the bench lets go of was not needed."""

    def __init__(self, bench: Workbench) -> None:
        self._bench = bench
        self._done: set[tuple[str, int]] = set()

    def start(self) -> None:
        """Read what there is, then go on in a thread for the rest of this process's life."""
        self.look_or_tell()
        threading.Thread(target=self._keep_looking, name="read-ahead", daemon=True).start()

    def look(self) -> None:
        """Read new versions of the sites that are in use and, while there is room, of the newest others.

        Raises
        ------
        StorageUnavailable
        """
        held = self._bench.held()
        in_use = {site_id for site_id, _ in held}
        with self._bench.database.reading() as session:
            versions = newest_versions(session, in_use, MAPS_HELD)
        room = MAPS_HELD - len(held)
        for key in versions:
            if key in held or key in self._done or (key[0] not in in_use and room <= 0):
                continue
            room -= 1
            self._read(key)

    def look_or_tell(self) -> None:
        """``look``; without a database nothing is read ahead, and a snapshot that needs a map will say why."""
        try:
            self.look()
        except (StorageUnavailable, OutOfSpace) as error:
            log.debug("no maps were read ahead: %s", error.detail)

    def _read(self, key: tuple[str, int]) -> None:
        self._done.add(key)
        try:
            self._bench.target_map(*key)
        except NotFound:
            log.debug("site %s was deleted while its map was read ahead", key[0])

    def _keep_looking(self) -> None:
        pause = threading.Event()  # nobody sets it: the process ends without asking
        while not pause.wait(INTERVAL_S):
            self.look_or_tell()
