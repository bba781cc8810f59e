"""Whether this server can do its work now."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from app.errors import ScattermarkError
from app.services.ports import CpuPool
from app.storage.database import Database
from app.storage.migrate import check_tables
from app.storage.photo_store import PhotoStore

OK = "ok"


class Readiness:
    """Looks at what requests depend on: database, tables, photographs, workers.

    Parameters
    ----------
    database : Database
    photos : PhotoStore
    pools : dict of CpuPool by name
    """

    def __init__(self, database: Database, photos: PhotoStore, pools: dict[str, CpuPool]) -> None:
        self._database = database
        self._photos = photos
        self._pools = pools

    def checks(self) -> dict[str, str]:
        """Each check by name: ``ok``, or what is wrong and what to do."""
        checks = {
            "database": _outcome(self._database.ping),
            "migrations": _outcome(partial(check_tables, self._database)),
            "photographs": _outcome(self._photos.check),
        }
        return {**checks, **{f"{name}_workers": _workers(pool) for name, pool in self._pools.items()}}


def _outcome(check: Callable[[], None]) -> str:
    try:
        check()
    except ScattermarkError as error:
        return error.detail
    return OK


def _workers(pool: CpuPool) -> str:
    return OK if pool.pids else "no worker process is alive: restart the server"
