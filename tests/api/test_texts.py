"""What people write: the check and the schema's pattern agree, and everything that passes can be stored."""

from __future__ import annotations

import re
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from app.api.schemas.texts import LongText, Text


@pytest.mark.parametrize("kind", [Text, LongText])
@given(text=st.text(max_size=20))
def test_what_the_schema_takes_is_taken(kind: Any, text: str) -> None:
    adapter: TypeAdapter[str] = TypeAdapter(kind)
    if re.search(adapter.json_schema()["pattern"], text):
        adapter.validate_python(text)


@pytest.mark.parametrize("kind", [Text, LongText])
@given(text=st.text(max_size=20))
def test_what_is_taken_can_be_stored_and_fits_the_schema(kind: Any, text: str) -> None:
    adapter: TypeAdapter[str] = TypeAdapter(kind)
    try:
        kept = adapter.validate_python(text)
    except ValidationError:
        return
    assert "\x00" not in kept
    assert re.search(adapter.json_schema()["pattern"], kept)


@pytest.mark.parametrize("name", ["Halle 3", "\u5e83\u5834", "caf\u00e9\u00a0\u2013 1", "\U0001f468\u200d\U0001f52c"])
def test_names_of_any_script(name: str) -> None:
    assert TypeAdapter(Text).validate_python(name) == name


@pytest.mark.parametrize("name", ["", "  ", "a\x00b", "a\nb", "\u202eabc"])
def test_no_name(name: str) -> None:
    with pytest.raises(ValidationError, match="cannot be seen"):
        TypeAdapter(Text).validate_python(name)
