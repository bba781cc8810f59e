"""One site's rows: which tables they are in, and which rows of each."""

from __future__ import annotations

from collections.abc import Callable

from sqlalchemy import ColumnElement, Connection, MetaData, Select, Table, func, select

from app.storage.archive_format import Progress
from app.storage.archive_rows import RowForm
from app.storage.archive_writer import ArchiveWriter
from app.storage.backup_rows import Counter, lines_of

Rows = Callable[[MetaData, str], ColumnElement[bool]]


def _of_site(name: str, column: str = "site_id") -> Rows:
    return lambda tables, site_id: tables.tables[name].columns[column] == site_id


def _of_maps(name: str) -> Rows:
    return lambda tables, site_id: tables.tables[name].columns["map_id"].in_(_ids(tables, "target_maps", site_id))


def _imported_poses(tables: MetaData, site_id: str) -> ColumnElement[bool]:
    return tables.tables["imported_poses"].columns["trajectory_id"].in_(_ids(tables, "trajectories", site_id))


def _photographs(tables: MetaData, site_id: str) -> ColumnElement[bool]:
    return tables.tables["photographs"].columns["survey_id"].in_(_ids(tables, "surveys", site_id))


def _marks(tables: MetaData, site_id: str) -> ColumnElement[bool]:
    return tables.tables["photo_marks"].columns["survey_id"].in_(_ids(tables, "surveys", site_id))


def _detections(tables: MetaData, site_id: str) -> ColumnElement[bool]:
    digests = select(tables.tables["photographs"].columns["sha256"]).where(_photographs(tables, site_id))
    return tables.tables["detections"].columns["sha256"].in_(digests)


def _ids(tables: MetaData, name: str, site_id: str) -> Select[tuple[str]]:
    table = tables.tables[name]
    return select(table.columns["id"]).where(table.columns["site_id"] == site_id)


# Left out: jobs, which are an installation's business; kept pictures of snapshots, whose removal is promised where they
# were taken; evaluations, which are made anew from the trajectories; alerts and their evidence, which are an
# installation's business as well: the snapshots that come tell them anew.
SITE_ROWS: dict[str, Rows] = {
    "sites": _of_site("sites", "id"),
    "control_points": _of_site("control_points"),
    "print_batches": _of_site("print_batches"),
    "surveys": _of_site("surveys"),
    "photographs": _photographs,
    "photo_marks": _marks,
    "detections": _detections,
    "target_maps": _of_site("target_maps"),
    "mapped_targets": _of_maps("mapped_targets"),
    "map_photos": _of_maps("map_photos"),
    "cameras": _of_site("cameras"),
    "trajectories": _of_site("trajectories"),
    "snapshots": _of_site("snapshots"),
    "imported_poses": _imported_poses,
}


def site_tables(tables: MetaData) -> tuple[Table, ...]:
    """The tables that hold a site, each after those that it refers to."""
    return tuple(table for table in tables.sorted_tables if table.name in SITE_ROWS)


def write_site(writer: ArchiveWriter, connection: Connection, tables: MetaData, site_id: str, report: Progress) -> None:
    """Add the rows of a site, as one transaction sees them."""
    wanted = {table: SITE_ROWS[table.name](tables, site_id) for table in site_tables(tables)}
    counts = [select(func.count()).select_from(table).where(rows) for table, rows in wanted.items()]
    counter = Counter(report, sum(connection.scalar(count) or 0 for count in counts))
    for table, rows in wanted.items():
        query = select(table).where(rows).order_by(*table.primary_key.columns)
        writer.add_table(table.name, RowForm(table).columns, lines_of(connection, query, table, counter))


def photos_of_site(connection: Connection, tables: MetaData, site_id: str) -> tuple[str, ...]:
    """Digests of a site's photographs, each once."""
    digest = tables.tables["photographs"].columns["sha256"]
    return tuple(connection.scalars(select(digest).where(_photographs(tables, site_id)).distinct().order_by(digest)))
