"""A photograph on its way in: hashed as it comes, in a file without a name, so that nothing is left of what breaks off.

What comes may hold positions. A file without a name is gone with its process, however that ends.
"""

from __future__ import annotations

import hashlib
import tempfile
from pathlib import Path
from types import TracebackType
from typing import Self

from app.errors import PhotoTooLarge
from app.storage.objects import translated


class IncomingPhoto:
    """Bytes that arrive, gone when the block ends.

    Parameters
    ----------
    spool : Path
        Folder of the disk that holds them meanwhile.
    max_bytes : int
    """

    def __init__(self, spool: Path, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._digest = hashlib.sha256()
        # Without a buffer: on a full disk closing would fail a second time.
        self._file = tempfile.TemporaryFile(dir=spool, buffering=0)  # noqa: SIM115 - see __exit__
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
        StorageUnavailable, OutOfSpace
        """
        if self.size_bytes + len(chunk) > self._max_bytes:
            raise PhotoTooLarge(
                f"the photograph has more than {self._max_bytes} bytes; send it smaller or more strongly compressed",
                max_bytes=self._max_bytes,
            )
        rest = memoryview(chunk)
        with translated():
            while rest:
                rest = rest[self._file.write(rest) :]
        self.size_bytes += len(chunk)
        self._digest.update(chunk)

    def content(self) -> bytes:
        """All that has come."""
        with translated():
            self._file.seek(0)
            return self._file.read()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
