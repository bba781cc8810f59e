"""A worker's place on its machine: held by one process at a time, and free the moment that process is gone."""

from __future__ import annotations

import contextlib
import os
import secrets
import socket
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from io import BufferedRandom
from itertools import count
from pathlib import Path

NONCE_BYTES = 8  # makes the places of two folders differ, even on one machine


@dataclass(frozen=True)
class Slot:
    """A place that this process holds.

    Attributes
    ----------
    name : str
        Machine and ordinal, for people.
    key : str
        The same for whoever holds this place before and after, on this machine, over this folder.
    """

    name: str
    key: str


@contextlib.contextmanager
def held_slot(folder: Path) -> Iterator[Slot]:
    """The lowest free place of a folder, until the block ends or the process dies, however it dies."""
    folder.mkdir(parents=True, exist_ok=True)
    host = socket.gethostname()
    for ordinal in count():
        with (folder / f"slot-{ordinal}").open("a+b") as file:
            if _locked(file):
                yield Slot(f"{host}/{ordinal}", f"{host}/{ordinal}/{_nonce(file)}")
                return


def _nonce(file: BufferedRandom) -> str:
    """What the place was called when it was first taken. A copied folder keeps it: the machine's name is beside it."""
    file.seek(0)
    written = file.read().decode("ascii")
    if written:
        return written
    nonce = secrets.token_hex(NONCE_BYTES)
    file.write(nonce.encode("ascii"))
    file.flush()
    os.fsync(file.fileno())
    return nonce


def _locked(file: BufferedRandom) -> bool:
    """Take the operating system's lock on a file, which ends with the process; False when another process has it."""
    try:
        if sys.platform == "win32":
            import msvcrt

            file.seek(2 * NONCE_BYTES)  # behind the nonce, which others may then read
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    return True
