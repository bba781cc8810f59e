"""The story of an import: a file arrives -> a worker reads and keeps it; the process that serves never parses it."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import AsyncIterable, AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

from app.services.ports import CpuPool
from app.services.trajectory_import_work import ImportTask, ImportWish, import_trajectory
from app.storage.audit import waiting_entry
from app.storage.objects import translated
from app.storage.trajectory_parts import StoredTrajectory

Chunks = AsyncIterable[bytes]


@dataclass(frozen=True)
class ArrivingFile:
    """A file that a client is sending, with the stamps' own file if there is one."""

    poses: Chunks
    times: Chunks | None = None


class TrajectoryImporter:
    """Takes files of trajectories.

    Parameters
    ----------
    pool : CpuPool
        Whose workers have a workbench and see this machine's disk.
    timeout_s : float
        Of reading and keeping one file.
    scratch : Path
        Folder of a disk that can hold a file while it is read.
    """

    def __init__(self, pool: CpuPool, timeout_s: float, scratch: Path) -> None:
        self._pool = pool
        self._timeout_s = timeout_s
        self._scratch = scratch

    async def take(self, wish: ImportWish, arriving: ArrivingFile) -> StoredTrajectory:
        """A trajectory from a file that is arriving.

        Raises
        ------
        NotFound, UnreadableTrajectory, InvalidInput, Conflict
            As ``import_trajectory``; nothing is kept then.
        OutOfSpace
            When the disk cannot hold the file.
        ServerFull, TimedOut, WorkerCrashed
            When the work could not be done; nothing is kept.
        """
        async with AsyncExitStack() as files:
            poses = await files.enter_async_context(self._on_disk(arriving.poses))
            times = None if arriving.times is None else await files.enter_async_context(self._on_disk(arriving.times))
            task = ImportTask(wish, poses, times, waiting_entry())
            trajectory: StoredTrajectory = await self._pool.run(import_trajectory, task, timeout_s=self._timeout_s)
        return trajectory

    @asynccontextmanager
    async def _on_disk(self, chunks: Chunks) -> AsyncIterator[Path]:
        """The path of a file that holds what arrives, and is gone when the block ends."""
        with tempfile.NamedTemporaryFile(dir=self._scratch, prefix="trajectory-") as file:
            async for chunk in chunks:
                await asyncio.to_thread(_write, file, chunk)
            await asyncio.to_thread(_flush, file)
            yield Path(file.name)


def _write(file: tempfile._TemporaryFileWrapper[bytes], chunk: bytes) -> None:
    with translated():
        file.write(chunk)


def _flush(file: tempfile._TemporaryFileWrapper[bytes]) -> None:
    with translated():
        file.flush()
