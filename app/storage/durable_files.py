"""Files that are there whole or not at all, also after a power cut: written aside, synced, renamed, folder synced."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def write_whole(place: Path, data: bytes, aside: Path) -> None:
    """Write a file; when this returns, its bytes and its name are on the disk.

    Parameters
    ----------
    place : Path
        Folders above it are made.
    data : bytes
    aside : Path
        Folder of the same file system; what a killed process leaves there is no file of anybody's.

    Raises
    ------
    OSError
        When it cannot be written, for want of room as well; then nothing is there.
    """
    made = [folder for folder in place.parents if not folder.exists()]
    place.parent.mkdir(parents=True, exist_ok=True)
    descriptor, name = tempfile.mkstemp(dir=aside)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        Path(name).replace(place)  # a twin that arrives at the same moment has the same bytes
    finally:
        Path(name).unlink(missing_ok=True)
    for folder in [place.parent, *(folder.parent for folder in made)]:
        sync_folder(folder)


def sync_folder(folder: Path) -> None:
    """Make the names in a folder survive a power cut."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
