"""Rows survive the way through an archive exactly, and nothing else passes for a row."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import JSON, BigInteger, Boolean, Column, Double, Integer, LargeBinary, MetaData, String, Table

from app.storage.archive_format import BadArchive
from app.storage.archive_rows import RowForm

TABLE = Table(
    "things",
    MetaData(),
    Column("id", String(36), primary_key=True),
    Column("count", Integer()),
    Column("size", BigInteger()),
    Column("x_m", Double()),
    Column("sure", Boolean()),
    Column("blob", LargeBinary()),
    Column("seen", JSON()),
)
FORM = RowForm(TABLE)
GOOD: list[Any] = ["a", 1, 2**40, 0.5, True, "AAE=", {"k": [1, None]}]

TEXTS = st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]))
ROWS = st.tuples(
    TEXTS,
    st.none() | st.integers(-(2**31) + 1, 2**31 - 1),
    st.none() | st.integers(-(2**63) + 1, 2**63 - 1),
    st.none() | st.floats(),
    st.none() | st.booleans(),
    st.none() | st.binary(),
    st.recursive(st.none() | st.booleans() | st.floats(allow_nan=False, allow_infinity=False) | TEXTS, st.lists),
)


@given(ROWS)
def test_a_row_comes_back_exactly(row: tuple[Any, ...]) -> None:
    line = FORM.line(row)
    assert line.count(b"\n") == 1 and line.endswith(b"\n")
    back = tuple(FORM.values(line).values())
    for before, after in zip(row, back, strict=True):
        assert type(before) is type(after)
        assert before == after or (isinstance(before, float) and math.isnan(before) and math.isnan(after))


@pytest.mark.parametrize(
    ("column", "value"),
    [
        (0, 7),
        (0, "a\0b"),
        (0, "\ud800"),
        (1, "1"),
        (1, True),
        (1, 1.0),
        (1, 2**31),
        (2, 2**63),
        (3, "0.5"),
        (3, True),
        (4, 1),
        (5, "AA!="),
        (5, "\xe9"),
        (5, 5),
    ],
)
def test_a_value_of_another_type_is_refused(column: int, value: Any) -> None:
    row = [*GOOD]
    row[column] = value
    with pytest.raises(BadArchive, match="table things"):
        FORM.values(json.dumps(row).encode())


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"nonsense",
        b"{}",
        b"[]",
        b'["a"]',
        b'["a",1,2,NaN,true,"",null]',
        b"[" * 100_000,
        b'["\xff",1,2,0.5,true,"",null]',
        b'["a",' + b"9" * 5000 + b',2,0.5,true,"",null]',
    ],
)
def test_what_is_no_row_is_refused(line: bytes) -> None:
    with pytest.raises(BadArchive, match="table things"):
        FORM.values(line)


def test_the_good_row_is_good() -> None:
    assert FORM.values(json.dumps(GOOD).encode()) == {
        "id": "a",
        "count": 1,
        "size": 2**40,
        "x_m": 0.5,
        "sure": True,
        "blob": b"\0\1",
        "seen": {"k": [1, None]},
    }
