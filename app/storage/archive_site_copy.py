"""From the scratch database into the installation's: rows that belong to one site, under its ids or new ones."""

from __future__ import annotations

import hashlib
import hmac
import secrets
import uuid
from collections.abc import Iterator
from typing import Any

from sqlalchemy import Connection, Table, insert, select
from sqlalchemy.exc import IntegrityError

from app.errors import Conflict
from app.storage.archive_format import Progress
from app.storage.archive_schema import known_revisions, tables_at
from app.storage.archive_site import site_tables
from app.storage.archive_site_scratch import OUR_IDS
from app.storage.backup_rows import ROWS_AT_ONCE
from app.storage.database import Session
from app.storage.ids import RANDOM_BITS_B
from app.storage.models import DetectionRow, SiteRow
from app.storage.trajectory_rows import default_key
from app.storage.upsert import insert_what_is_absent


class Ids:
    """The ids that imported rows get: their own, or new ones that sort as the old ones did.

    Parameters
    ----------
    new : bool
        A new id keeps the time and what sorts within a millisecond; the rest depends on the old id and on a secret of
        this import, so that one old id is one new id in every table and nothing need be remembered.
    """

    def __init__(self, *, new: bool) -> None:
        self._secret = secrets.token_bytes(32) if new else None

    def of(self, identifier: str) -> str:
        """The id under which a thing is kept here."""
        if self._secret is None:
            return identifier
        digest = hmac.digest(self._secret, identifier.encode(), hashlib.sha256)
        kept = uuid.UUID(identifier).int >> RANDOM_BITS_B << RANDOM_BITS_B
        return str(uuid.UUID(int=kept | int.from_bytes(digest) % 2**RANDOM_BITS_B))


def copy_site(scratch: Connection, session: Session, ids: Ids, report: Progress) -> str:
    """Add the site of a scratch database; its id here.

    Detections of a photograph that are there already stay as they are.

    Raises
    ------
    Conflict
        When the site, or anything of it, is there already.
    """
    tables = site_tables(tables_at(known_revisions()[0]))
    sites, *others = tables_with_sites_first(tables)
    ((site,),) = _batches(scratch, sites, ids)
    if session.get(SiteRow, site["id"]) is not None:
        raise Conflict(
            f"site {site['id']} is here already: import the archive as a new site (--as-new, ?as_new=true), or remove "
            "the one that is here first",
            site_id=site["id"],
        )
    session.add(SiteRow(**site))
    try:
        session.flush()
        for done, table in enumerate(others):
            report("tables", done, len(others))
            for rows in _batches(scratch, table, ids):
                _insert(session.connection(), table, rows)
    except IntegrityError as error:
        raise Conflict(
            "something of the archive is here already under another site: import it as a new site (--as-new, "
            "?as_new=true)"
        ) from error
    report("tables", len(others), len(others))
    return str(site["id"])


def tables_with_sites_first(tables: tuple[Table, ...]) -> list[Table]:
    """Everything else belongs to the site."""
    return sorted(tables, key=lambda table: table.name != "sites")


def _insert(connection: Connection, table: Table, rows: list[dict[str, Any]]) -> None:
    if table.name == DetectionRow.__tablename__:
        insert_what_is_absent(connection, DetectionRow, rows)
    else:
        connection.execute(insert(table), rows)


def _batches(scratch: Connection, table: Table, ids: Ids) -> Iterator[list[dict[str, Any]]]:
    result = scratch.execution_options(yield_per=ROWS_AT_ONCE).execute(select(table))
    for batch in result.mappings().partitions():
        yield [_renamed(table.name, dict(row), ids) for row in batch]


def _renamed(table: str, values: dict[str, Any], ids: Ids) -> dict[str, Any]:
    for name in OUR_IDS & values.keys():
        if values[name] is not None:
            values[name] = ids.of(values[name])
    if table == "target_maps":
        values["job_id"] = None  # its job stayed behind; a job of here that bore this id would never publish
    if table == "trajectories" and values["default_key"] is not None:
        values["default_key"] = default_key(values["site_id"], values["device_id"])
    return values
