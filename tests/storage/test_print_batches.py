from __future__ import annotations

import pytest

from app.errors import NotFound
from app.geometry.print_batch import PrintBatch
from app.storage.database import Database
from app.storage.print_batches import PrintBatchRepository, every_batch
from app.storage.sites import SiteRepository
from tests.storage import examples

BATCHES = (
    PrintBatch("second floor", (101, 389), 99.2, 98.75, 0.2),
    PrintBatch("first floor", (7,), 100.0, 100.1, 0.05),
)


def test_batches_come_back_in_order_and_are_replaced_as_a_whole(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        PrintBatchRepository(session).replace(site.site_id, BATCHES)
    with database.writing() as session:
        assert PrintBatchRepository(session).of_site(site.site_id) == BATCHES
        assert set(every_batch(session)) == set(BATCHES)
        PrintBatchRepository(session).replace(site.site_id, BATCHES[1:])
    with database.reading() as session:
        assert PrintBatchRepository(session).of_site(site.site_id) == BATCHES[1:]


def test_batches_go_with_their_site(database: Database) -> None:
    site, _ = examples.site_with_survey(database)
    with database.writing() as session:
        PrintBatchRepository(session).replace(site.site_id, BATCHES)
        SiteRepository(session).delete(site.site_id)
        assert not list(every_batch(session))
        with pytest.raises(NotFound):
            PrintBatchRepository(session).of_site(site.site_id)
