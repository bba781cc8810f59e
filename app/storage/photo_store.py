"""Photographs by digest: written once, whole or not at all. A folder here; an object store can take its place."""

from __future__ import annotations

import hashlib
import os
import tempfile
import time
from pathlib import Path
from types import TracebackType
from typing import IO, Self

from app.errors import NotFound, PhotoTooLarge

ABANDONED_AFTER_S = 24 * 3600.0  # no upload lasts a day; what a killed process left behind is older at some start


class PhotoStore:
    """A folder of photographs named by their SHA-256.

    Parameters
    ----------
    folder : Path
        Made when it is missing.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._incoming = folder / "incoming"
        self._incoming.mkdir(parents=True, exist_ok=True)

    def receive(self, max_bytes: int) -> IncomingPhoto:
        """A place for a photograph that is arriving."""
        return IncomingPhoto(self._incoming, self._folder, max_bytes)

    def read(self, sha256: str) -> bytes:
        """The bytes of a photograph.

        Raises
        ------
        NotFound
            When the store has lost it.
        """
        try:
            return _place(self._folder, sha256).read_bytes()
        except FileNotFoundError as error:
            raise NotFound(
                f"the file of photograph {sha256} is gone from the store; restore it from a backup or upload it again",
                sha256=sha256,
            ) from error

    def holds(self, sha256: str) -> bool:
        """Whether the photograph is there."""
        return _place(self._folder, sha256).is_file()

    def sweep(self) -> None:
        """Remove what uploads of killed processes left behind."""
        oldest_s = time.time() - ABANDONED_AFTER_S
        for path in self._incoming.iterdir():
            if path.stat().st_mtime < oldest_s:
                path.unlink(missing_ok=True)


class IncomingPhoto:
    """Bytes on their way in: hashed as they come, gone when the block ends unless ``keep`` was called."""

    def __init__(self, incoming: Path, folder: Path, max_bytes: int) -> None:
        self._folder = folder
        self._max_bytes = max_bytes
        self._digest = hashlib.sha256()
        self._file: IO[bytes] = tempfile.NamedTemporaryFile(dir=incoming, delete=False)  # noqa: SIM115 - see __exit__
        self._path = Path(self._file.name)
        self.size_bytes = 0

    @property
    def sha256(self) -> str:
        """Digest of what has come so far."""
        return self._digest.hexdigest()

    def write(self, chunk: bytes) -> None:
        """Take some more bytes.

        Raises
        ------
        PhotoTooLarge
            When the limit is passed.
        """
        self.size_bytes += len(chunk)
        if self.size_bytes > self._max_bytes:
            raise PhotoTooLarge(
                f"the photograph has more than {self._max_bytes} bytes; send it smaller or more strongly compressed",
                max_bytes=self._max_bytes,
            )
        self._digest.update(chunk)
        self._file.write(chunk)

    def content(self) -> bytes:
        """All that has come."""
        self._file.flush()
        return self._path.read_bytes()

    def keep(self) -> None:
        """Put the photograph in its place; what is there already stays as it is."""
        self._file.flush()
        os.fsync(self._file.fileno())
        place = _place(self._folder, self.sha256)
        if not place.exists():
            place.parent.mkdir(parents=True, exist_ok=True)
            self._path.replace(place)  # a twin that arrives at the same moment has the same bytes
            _sync_folder(place.parent)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
        self._path.unlink(missing_ok=True)


def _place(folder: Path, sha256: str) -> Path:
    return folder / sha256[:2] / sha256[2:4] / sha256


def _sync_folder(folder: Path) -> None:
    """Make a rename survive a power cut."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
