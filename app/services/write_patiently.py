"""The result of long work is written though the database is away for a while."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from typing import TypeVar

from app.errors import StorageUnavailable

log = logging.getLogger(__name__)

Result = TypeVar("Result")

# A database that restarts is back within a minute; the result of an hour's adjustment waits four for it.
PAUSES_S = (1.0, 2.0, 4.0, 8.0, 15.0, 30.0, 60.0, 120.0)


def write_patiently(job_id: str, write: Callable[[], Result]) -> Result:
    """``write()``, tried again while the database gives no answer.

    Raises
    ------
    StorageUnavailable
        When it stays away.
    """
    for pause_s in PAUSES_S:
        try:
            return write()
        except StorageUnavailable as error:
            log.warning("the result of job %s cannot be written yet: %s", job_id, error.detail)
            time.sleep(pause_s)
    return write()
