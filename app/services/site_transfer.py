"""Sites on their way out of and into a running service: few at a time, each whole or not at all."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import AsyncIterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain
from threading import BoundedSemaphore
from typing import IO

from app.errors import ServerFull
from app.services.site_transfer_export import SiteSource, site_chunks
from app.services.site_transfer_import import ImportedSite, ImportLimits, SiteTarget, import_site
from app.services.storage_budget import StorageBudget
from app.storage.database import Database
from app.storage.objects import translated
from app.storage.photo_store import PhotoStore

RETRY_AFTER_S = 30


@dataclass(frozen=True)
class TransferLimits:
    """What a transfer may take.

    Attributes
    ----------
    incoming : ImportLimits
    at_once : int
        Exports and imports together: they share the processor with snapshots.
    """

    incoming: ImportLimits
    at_once: int = 2


class SiteTransfers:
    """Exports and imports of one server.

    Parameters
    ----------
    database : Database
    photos : PhotoStore
    budget : StorageBudget
    limits : TransferLimits
    """

    def __init__(self, database: Database, photos: PhotoStore, budget: StorageBudget, limits: TransferLimits) -> None:
        self._database = database
        self._photos = photos
        self._budget = budget
        self._limits = limits
        self._places = BoundedSemaphore(limits.at_once)

    def export(self, site_id: str) -> Iterator[bytes]:
        """A site's archive as it is made.

        Raises
        ------
        NotFound
        ServerFull
            When other transfers are under way.
        """
        chunks = self._exported(site_id)
        return chain([next(chunks)], chunks)  # what is wrong is wrong before the answer begins

    async def take(self, chunks: AsyncIterable[bytes], *, as_new: bool) -> ImportedSite:
        """Import a site from an archive that is arriving.

        Raises
        ------
        BadArchive, Conflict
            As ``import_site``.
        ServerFull
            When other transfers are under way.
        OutOfSpace, StorageUnavailable
        """
        with self._place(), tempfile.TemporaryFile(dir=self._limits.incoming.scratch, buffering=0) as file:
            async for chunk in chunks:
                await asyncio.to_thread(_write, file, chunk)
            return await asyncio.to_thread(self._import, file, as_new)

    def _exported(self, site_id: str) -> Iterator[bytes]:
        with self._place():
            yield from site_chunks(SiteSource(self._database, self._photos, site_id))

    def _import(self, file: IO[bytes], as_new: bool) -> ImportedSite:
        target = SiteTarget(self._database, self._photos, self._budget, self._limits.incoming, as_new)
        return import_site(file, target, _quiet)

    @contextmanager
    def _place(self) -> Iterator[None]:
        if not self._places.acquire(blocking=False):
            raise ServerFull(
                f"{self._limits.at_once} sites are being exported or imported at this moment; come back later",
                retry_after_s=RETRY_AFTER_S,
            )
        try:
            yield
        finally:
            self._places.release()


def _quiet(_stage: str, _done: int, _total: int) -> None:
    """A request tells nobody how far it is."""


def _write(file: IO[bytes], chunk: bytes) -> None:
    rest = memoryview(chunk)
    with translated():
        while rest:
            rest = rest[file.write(rest) :]
