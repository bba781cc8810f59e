"""What an archive is: a zip file of rows and photographs with a manifest that says what must be in it.

``manifest.json``            what follows, with the SHA-256 of each table
``tables/<name>.jsonl``      one row a line, deflated
``photographs/<sha256>``     as they were taken, stored
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, Literal, cast

from app.errors import InvalidInput

FORMAT = "scattermark-archive"
FORMAT_VERSION = 1
MANIFEST_NAME = "manifest.json"
MAX_MANIFEST_BYTES = 64 * 2**20  # it grows with the photographs that a damaged store has lost, 67 bytes each
SHA256 = re.compile(r"[0-9a-f]{64}")
TABLE_NAME = re.compile(r"[a-z][a-z0-9_]{0,62}")  # 63 is Postgres's limit

Kind = Literal["backup", "site"]
Progress = Callable[[str, int, int], None]  # stage, done, total


class BadArchive(InvalidInput):
    """A file that is no archive of this program, or not any more: truncated, altered, of a newer release."""

    slug = "bad-archive"


@dataclass(frozen=True)
class TableMember:
    """The rows of one table in an archive."""

    name: str
    columns: tuple[str, ...]
    rows: int
    size_bytes: int
    sha256: str

    def __post_init__(self) -> None:
        if not TABLE_NAME.fullmatch(self.name) or not SHA256.fullmatch(self.sha256):
            raise ValueError(f"{self.name!r:.80} is no table of an archive")
        if self.rows < 0 or self.size_bytes < 0 or len(set(self.columns)) != len(self.columns):
            raise ValueError(f"table {self.name} is not described soundly")


@dataclass(frozen=True)
class Heading:
    """Where an archive comes from.

    Attributes
    ----------
    kind : str
        ``backup``: a whole installation; ``site``: one site.
    revision : str
        Of the database that the rows were read from.
    created_s : float
        UTC, seconds since 1970.
    """

    kind: Kind
    revision: str
    app_version: str
    created_s: float

    def __post_init__(self) -> None:
        if self.kind not in ("backup", "site"):
            raise ValueError(f"{self.kind!r:.40} is no kind of archive")


@dataclass(frozen=True)
class Photographs:
    """The photographs of an archive.

    Attributes
    ----------
    included : bool
        False when whoever made the archive wanted the rows only.
    missing : tuple of str
        Digests that rows refer to and the store did not hold unaltered.
    """

    included: bool
    count: int = 0
    size_bytes: int = 0
    missing: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.count < 0 or self.size_bytes < 0 or not all(SHA256.fullmatch(digest) for digest in self.missing):
            raise ValueError("the photographs are not described soundly")


@dataclass(frozen=True)
class Manifest:
    """What an archive holds."""

    heading: Heading
    tables: tuple[TableMember, ...]
    photographs: Photographs

    @property
    def rows(self) -> int:
        """Rows of all tables."""
        return sum(table.rows for table in self.tables)

    @property
    def size_bytes(self) -> int:
        """Of all tables and photographs, unpacked."""
        return sum(table.size_bytes for table in self.tables) + self.photographs.size_bytes


def name_of_table(name: str) -> str:
    """A table's place in the zip file."""
    return f"tables/{name}.jsonl"


def name_of_photo(sha256: str) -> str:
    """A photograph's place in the zip file."""
    return f"photographs/{sha256}"


def bytes_of_manifest(manifest: Manifest) -> bytes:
    """A manifest as JSON."""
    record = {"format": FORMAT, "format_version": FORMAT_VERSION, **asdict(manifest)}
    return json.dumps(record, indent=1, allow_nan=False).encode()


def manifest_of_bytes(data: bytes) -> Manifest:
    """The manifest of ``bytes_of_manifest``.

    Raises
    ------
    BadArchive
    """
    try:
        record = json.loads(data)
        if type(record) is not dict or record.get("format") != FORMAT:
            raise BadArchive("the file is no archive of Scattermark: its manifest says something else")
        _refuse_newer(record["format_version"])
        return Manifest(
            heading=Heading(**_checked(record["heading"], kind=str, revision=str, app_version=str, created_s=float)),
            tables=tuple(_table(table) for table in record["tables"]),
            photographs=_photographs(record["photographs"]),
        )
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        raise BadArchive(f"the archive's manifest cannot be read ({error!r:.200}); take another copy") from error


def _refuse_newer(version: Any) -> None:
    if version != FORMAT_VERSION:
        raise BadArchive(
            f"the archive has format {version!r:.20} and this release reads {FORMAT_VERSION}: install the release that "
            "wrote it, or a later one"
        )


def _table(record: Any) -> TableMember:
    values = _checked(record, name=str, columns=list, rows=int, size_bytes=int, sha256=str)
    columns = tuple(column for column in values["columns"] if type(column) is str)
    if len(columns) != len(values["columns"]):
        raise ValueError("columns have names")
    return TableMember(**{**values, "columns": columns})


def _photographs(record: Any) -> Photographs:
    values = _checked(record, included=bool, count=int, size_bytes=int, missing=list)
    return Photographs(**{**values, "missing": tuple(cast("list[str]", values["missing"]))})


def _checked(record: Any, **types: type) -> dict[str, Any]:
    """The members of a JSON object, each of its type, and no other."""
    if type(record) is not dict or set(record) != set(types):
        raise ValueError(f"an object with {', '.join(types)} is needed")
    for name, wanted in types.items():
        if type(record[name]) is not wanted:
            raise ValueError(f"{name} is no {wanted.__name__}")
    return record
