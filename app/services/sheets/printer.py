"""The story of sheets: a wish -> what the site decides -> pages -> read back -> file."""

from __future__ import annotations

from app.services.ports import CpuPool
from app.services.sheets.wish import SheetsWish
from app.services.sheets.work import write_sheets


class SheetPrinter:
    """Writes sheets in the pool: hundreds of pages take seconds.

    Parameters
    ----------
    pool : CpuPool
    timeout_s : float
        Of one file.
    """

    def __init__(self, pool: CpuPool, timeout_s: float) -> None:
        self._pool = pool
        self._timeout_s = timeout_s

    async def write(self, wish: SheetsWish) -> bytes:
        """The sheets as a PDF.

        Raises
        ------
        InvalidInput
            When the wish cannot be printed.
        SheetUnreadable
            When a page does not show what it should.
        ServerFull, TimedOut, WorkerCrashed
            When the work could not be done.
        """
        pdf: bytes = await self._pool.run(write_sheets, wish, timeout_s=self._timeout_s)
        return pdf
