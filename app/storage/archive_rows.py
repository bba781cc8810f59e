"""Rows as lines of JSON and back: exact, typed by the table's columns, the same for both kinds of database."""

from __future__ import annotations

import base64
import binascii
import json
import math
from collections.abc import Callable, Sequence
from typing import Any

from sqlalchemy import JSON, BigInteger, Boolean, Column, Float, Integer, LargeBinary, Table

from app.storage.archive_format import BadArchive

Code = Callable[[Any], Any]

GREATEST_INTEGER = 2**31 - 1  # of a column of both databases
GREATEST_BIG_INTEGER = 2**63 - 1
ODD_FLOATS = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}  # JSON has no such numbers


class RowForm:
    """How the rows of one table are written and read.

    Parameters
    ----------
    table : Table
        Of ``tables_at``.
    """

    def __init__(self, table: Table) -> None:
        self._name = table.name
        self.columns = tuple(column.name for column in table.columns)
        self._encoders = tuple(_encoder(column) for column in table.columns)
        self._decoders = tuple(_decoder(column) for column in table.columns)

    def line(self, row: Sequence[Any]) -> bytes:
        """A row, its values in the order of the columns, as one line."""
        values = [
            value if value is None or encode is None else encode(value)
            for encode, value in zip(self._encoders, row, strict=True)
        ]
        return json.dumps(values, separators=(",", ":"), allow_nan=False).encode() + b"\n"

    def values(self, line: bytes) -> dict[str, Any]:
        """The values of a line by column.

        Raises
        ------
        BadArchive
            When it is no such row.
        """
        try:
            record = json.loads(line, parse_constant=_refuse_constant)
            if type(record) is not list or len(record) != len(self.columns):
                raise ValueError(f"{len(self.columns)} values are needed")
            return {
                name: None if value is None else decode(value)
                for name, decode, value in zip(self.columns, self._decoders, record, strict=True)
            }
        except (ValueError, RecursionError, binascii.Error) as error:
            raise BadArchive(f"the archive holds a row that table {self._name} cannot take ({error})") from error


def _encoder(column: Column[Any]) -> Code | None:
    if isinstance(column.type, LargeBinary):
        return _text_of_bytes
    if isinstance(column.type, Float):
        return _json_of_float
    return None


def _decoder(column: Column[Any]) -> Code:
    kind = column.type
    if isinstance(kind, JSON):
        return _any_json
    if isinstance(kind, LargeBinary):
        return _bytes_of_text
    if isinstance(kind, Boolean):
        return _boolean
    if isinstance(kind, Integer):
        return _big_integer if isinstance(kind, BigInteger) else _integer
    return _float_of_json if isinstance(kind, Float) else _text


def _text_of_bytes(value: bytes) -> str:
    return base64.b64encode(value).decode("ascii")


def _bytes_of_text(value: Any) -> bytes:
    return base64.b64decode(_text(value), validate=True)


def _json_of_float(value: float) -> float | str:
    return value if math.isfinite(value) else str(value)


def _float_of_json(value: Any) -> float:
    if type(value) is float or type(value) is int:
        return float(value)
    if isinstance(value, str) and value in ODD_FLOATS:
        return ODD_FLOATS[value]
    raise ValueError(f"{value!r:.40} is no number")


def _integer(value: Any) -> int:
    if type(value) is int and abs(value) <= GREATEST_INTEGER:
        return value
    raise ValueError(f"{value!r:.40} is no integer of 32 bits")


def _big_integer(value: Any) -> int:
    if type(value) is int and abs(value) <= GREATEST_BIG_INTEGER:
        return value
    raise ValueError(f"{value!r:.40} is no integer of 64 bits")


def _boolean(value: Any) -> bool:
    if type(value) is bool:
        return value
    raise ValueError(f"{value!r:.40} is neither true nor false")


def _text(value: Any) -> str:
    if type(value) is str and "\0" not in value:  # which Postgres takes in no text
        value.encode()  # half a surrogate pair is no text either; UnicodeError is a ValueError
        return value
    raise ValueError(f"{value!r:.40} is no text")


def _any_json(value: Any) -> Any:
    return value


def _refuse_constant(name: str) -> Any:
    raise ValueError(f"{name} is no number of JSON")
