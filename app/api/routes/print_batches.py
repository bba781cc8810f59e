"""Print batches of a site: check bars that measure otherwise than they should are entered here."""

from __future__ import annotations

from fastapi import APIRouter

from app.api.dependencies import PathId, ReadSession, WriteSession
from app.api.problems import problems
from app.api.schemas.print_batches import PrintBatchesAnswer, PrintBatchesBody
from app.api.security import needs
from app.services import print_batches
from app.storage.print_batches import PrintBatchRepository

router = APIRouter(tags=["sites"])


@router.put("/sites/{site_id}/print-batches", dependencies=[needs("survey")], responses=problems(400, 404, 413, 422))
def put_print_batches(site_id: PathId, body: PrintBatchesBody, session: WriteSession) -> PrintBatchesAnswer:
    """Replace a site's print batches; builds from now on scale their targets by the measured bars."""
    entries = [batch.to_domain() for batch in body.print_batches]
    return PrintBatchesAnswer.of(site_id, print_batches.put_print_batches(session, site_id, entries))


@router.get("/sites/{site_id}/print-batches", dependencies=[needs("survey", "analyse")], responses=problems(404, 422))
def get_print_batches(site_id: PathId, session: ReadSession) -> PrintBatchesAnswer:
    """The site's print batches in the order they were given."""
    return PrintBatchesAnswer.of(site_id, PrintBatchRepository(session).of_site(site_id))
