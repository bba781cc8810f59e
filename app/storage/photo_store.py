"""Photographs by digest: written once, whole or not at all, into a folder or an object store."""

from __future__ import annotations

import re
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from app.errors import NotFound
from app.storage.incoming_photo import IncomingPhoto
from app.storage.objects import FolderObjects, Objects, StoredObject, folder_of, remote_objects, translated

ABANDONED_AFTER_S = 24 * 3600.0  # no upload lasts a day; what a killed process left behind is older at some start
PLACE = re.compile(r"([0-9a-f]{2})/([0-9a-f]{2})/(\1\2[0-9a-f]{60})")


def open_photo_store(url: str) -> PhotoStore:
    """The photographs at an address; a folder is made when it is missing.

    Parameters
    ----------
    url : str
        A folder's path or ``file://`` URL; or ``s3://bucket/prefix?region=...&endpoint=...``, ``gs://bucket/prefix``,
        ``az://container/prefix``, whose credentials are taken from the environment.

    Raises
    ------
    InvalidInput
        For a URL that names no store.
    StorageUnavailable, OutOfSpace
        When the folder cannot be made.
    """
    folder = folder_of(url)
    if folder is None:
        return PhotoStore(remote_objects(url), Path(tempfile.gettempdir()))
    incoming = folder / "incoming"
    with translated():
        incoming.mkdir(parents=True, exist_ok=True)
    return PhotoStore(FolderObjects(folder, incoming), incoming)


class PhotoStore:
    """Photographs named by their SHA-256.

    Parameters
    ----------
    objects : Objects
        Where they lie.
    spool : Path
        Folder for what is arriving; of the disk that has to hold an upload.
    """

    def __init__(self, objects: Objects, spool: Path) -> None:
        self._objects = objects
        self._spool = spool

    def receive(self, max_bytes: int) -> IncomingPhoto:
        """A place for a photograph that is arriving; nothing of it is kept until it is ``put``.

        Raises
        ------
        StorageUnavailable, OutOfSpace
        """
        with translated():
            return IncomingPhoto(self._spool, max_bytes)

    def put(self, sha256: str, data: bytes) -> None:
        """Keep a photograph under its digest; one that is there stays as it is.

        Raises
        ------
        StorageUnavailable, OutOfSpace
            Then nothing of it is there.
        """
        self._objects.create(place_of(sha256), data)

    def read(self, sha256: str) -> bytes:
        """The bytes of a photograph.

        Raises
        ------
        NotFound
            When the store has lost it.
        StorageUnavailable
        """
        data = self._objects.read(place_of(sha256))
        if data is None:
            raise NotFound(
                f"the file of photograph {sha256} is gone from the store; restore it from a backup or upload it again",
                sha256=sha256,
            )
        return data

    def holds(self, sha256: str) -> bool:
        """Whether the photograph is there."""
        return self._objects.find(place_of(sha256)) is not None

    def delete(self, sha256: str) -> None:
        """Remove a photograph; none is none."""
        self._objects.delete(place_of(sha256))

    def photos(self) -> Iterator[StoredObject]:
        """Every photograph, named by its digest; what else lies there is none of the store's."""
        for item in self._objects.all():
            found = PLACE.fullmatch(item.name)
            if found is not None:
                yield StoredObject(found[3], item.size_bytes, item.modified_s)

    def check(self) -> None:
        """See whether photographs can be kept now.

        Raises
        ------
        StorageUnavailable, OutOfSpace
        """
        self._objects.check()

    def free_bytes(self) -> int:
        """Room on the disk that has to hold an upload."""
        with translated():
            return shutil.disk_usage(self._spool).free

    @property
    def local(self) -> bool:
        """Whether the photographs lie on this machine's disk."""
        return isinstance(self._objects, FolderObjects)

    def sweep(self, now_s: float | None = None, *, dry_run: bool = False) -> int:
        """Remove what killed processes left behind; how many files that are."""
        oldest_s = (time.time() if now_s is None else now_s) - ABANDONED_AFTER_S
        swept = 0
        with translated():
            for path in self._spool.iterdir() if self.local else ():
                if _modified_s(path) < oldest_s:
                    swept += 1
                    if not dry_run:
                        path.unlink(missing_ok=True)
        return swept


def place_of(sha256: str) -> str:
    """The object's name: a level of folders for each of the first two bytes, as no folder likes a million files."""
    return f"{sha256[:2]}/{sha256[2:4]}/{sha256}"


def _modified_s(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:  # its upload ended just now
        return float("inf")
