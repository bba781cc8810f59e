"""What a check is given and what it says."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from app.settings import Settings
from app.storage.database import Database
from app.storage.photo_store import PhotoStore

Severity = Literal["ok", "warning", "error"]


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at.

    Attributes
    ----------
    severity : str
        ``error``: work is refused or data is lost; ``warning``: it will be, or may be; ``ok``.
    check : str
        What was looked at.
    what : str
        What was found.
    advice : str
        What to do; empty when there is nothing to be done.
    """

    severity: Severity
    check: str
    what: str
    advice: str = ""


@dataclass(frozen=True)
class Patient:
    """The installation that is looked over.

    Attributes
    ----------
    variables : tuple of str
        Names of the ``SCATTERMARK_...`` variables of the environment.
    clock : callable
        This machine's, UTC seconds since 1970; asked when a check needs it, as others may take minutes.
    deep : bool
        Read every photograph and every index.
    """

    settings: Settings
    database: Database
    photos: PhotoStore
    variables: tuple[str, ...]
    clock: Callable[[], float] = time.time
    deep: bool = False

    @property
    def now_s(self) -> float:
        """The moment by the clock that was given, UTC, seconds since 1970."""
        return self.clock()


def ok(check: str, what: str) -> Finding:
    """Nothing to be done."""
    return Finding("ok", check, what)
