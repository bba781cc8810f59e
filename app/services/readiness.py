"""Whether this server can do its work now."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from app.errors import ScattermarkError
from app.services.ports import CpuPool
from app.storage.database import Database
from app.storage.migrate import check_tables

OK = "ok"


class Readiness:
    """Looks at what requests depend on: database, tables, photographs' folder, workers.

    Parameters
    ----------
    database : Database
    photographs_dir : Path
    pools : dict of CpuPool by name
    """

    def __init__(self, database: Database, photographs_dir: Path, pools: dict[str, CpuPool]) -> None:
        self._database = database
        self._photographs_dir = photographs_dir
        self._pools = pools

    def checks(self) -> dict[str, str]:
        """Each check by name: ``ok``, or what is wrong and what to do."""
        checks = {
            "database": _outcome(self._database.ping),
            "migrations": _outcome(partial(check_tables, self._database)),
            "photographs": _outcome(self._check_folder),
        }
        return {**checks, **{f"{name}_workers": _workers(pool) for name, pool in self._pools.items()}}

    def _check_folder(self) -> None:
        with tempfile.TemporaryFile(dir=self._photographs_dir):
            pass


def _outcome(check: Callable[[], None]) -> str:
    try:
        check()
    except ScattermarkError as error:
        return error.detail
    except OSError as error:
        return f"photographs cannot be written: {error}"
    return OK


def _workers(pool: CpuPool) -> str:
    return OK if pool.pids else "no worker process is alive: restart the server"
