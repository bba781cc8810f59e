"""What a worker process holds from one piece of work to the next: connections, photographs and target maps."""

from __future__ import annotations

from collections import OrderedDict
from threading import Lock

from app.geometry.target_map import TargetMap
from app.storage.database import Database
from app.storage.photo_store import PhotoStore, open_photo_store
from app.storage.target_maps import TargetMapRepository

MAPS_HELD = 16  # a map of 400 targets takes about 1 MB


class Workbench:
    """Database, photo store and the target maps used last; for the thread that works and one that reads ahead.

    Map versions never change, so one that is held is right for ever; a newly activated version is simply another one.
    """

    def __init__(self, database: Database, photos: PhotoStore) -> None:
        self.database = database
        self.photos = photos
        self._maps: OrderedDict[tuple[str, int], TargetMap] = OrderedDict()
        self._lock = Lock()

    def target_map(self, site_id: str, version: int) -> TargetMap:
        """A version of a site's map, read from the database when first needed."""
        key = site_id, version
        with self._lock:
            if key in self._maps:
                self._maps.move_to_end(key)
                return self._maps[key]
        with self.database.reading() as session:
            target_map = TargetMapRepository(session).load(site_id, version)
        with self._lock:
            self._maps[key] = target_map
            while len(self._maps) > MAPS_HELD:
                self._maps.popitem(last=False)
        return target_map

    def held(self) -> frozenset[tuple[str, int]]:
        """Sites and versions of the maps that are held."""
        with self._lock:
            return frozenset(self._maps)


class _Process:
    """The one workbench of this process."""

    workbench: Workbench | None = None


def open_workbench(database_url: str, photographs_url: str) -> None:
    """Set up this process; a worker's initializer calls it once."""
    _Process.workbench = Workbench(Database(database_url), open_photo_store(photographs_url))


def workbench() -> Workbench:
    """The workbench of this process."""
    if _Process.workbench is None:
        raise RuntimeError("open_workbench was not called in this process; give it to the pool as initializer")
    return _Process.workbench
