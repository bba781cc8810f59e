"""The print batches of sites in the database."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from app.geometry.print_batch import PrintBatch
from app.storage.ids import new_id
from app.storage.models import PrintBatchRow
from app.storage.sites import find_site_row


class PrintBatchRepository:
    """Print batches of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def replace(self, site_id: str, batches: Sequence[PrintBatch]) -> None:
        """Put these batches in the place of the site's present ones.

        Raises
        ------
        NotFound
        """
        find_site_row(self._session, site_id, lock=True)
        self._session.execute(delete(PrintBatchRow).where(PrintBatchRow.site_id == site_id))
        self._session.add_all(_row(site_id, ordinal, batch) for ordinal, batch in enumerate(batches))
        self._session.flush()

    def of_site(self, site_id: str) -> tuple[PrintBatch, ...]:
        """The site's batches in the order they were given.

        Raises
        ------
        NotFound
        """
        find_site_row(self._session, site_id)
        query = select(PrintBatchRow).where(PrintBatchRow.site_id == site_id).order_by(PrintBatchRow.ordinal)
        return tuple(_batch(row) for row in self._session.scalars(query))


def every_batch(session: Session) -> Iterator[PrintBatch]:
    """All batches of a database: of one that holds an arriving site.

    Raises
    ------
    ValueError
        For one that cannot be right.
    """
    return map(_batch, session.scalars(select(PrintBatchRow)))


def _row(site_id: str, ordinal: int, batch: PrintBatch) -> PrintBatchRow:
    return PrintBatchRow(
        id=new_id(),
        site_id=site_id,
        ordinal=ordinal,
        name=batch.name,
        codes=list(batch.codes),
        bar_across_mm=batch.bar_across_mm,
        bar_along_mm=batch.bar_along_mm,
        sigma_mm=batch.sigma_mm,
    )


def _batch(row: PrintBatchRow) -> PrintBatch:
    return PrintBatch(row.name, tuple(row.codes), row.bar_across_mm, row.bar_along_mm, row.sigma_mm)
