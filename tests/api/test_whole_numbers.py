"""Whole numbers as JSON has them: 3.0 is one; a text or a truth value is none."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from app.api.schemas.surveys import BuildBody


@pytest.mark.parametrize("text", ["3", "3.0", "3e0"])
def test_a_whole_number_is_whole_however_it_is_written(text: str) -> None:
    assert BuildBody.model_validate_json(f'{{"base_version": {text}}}').base_version == 3


@pytest.mark.parametrize("text", ["3.5", '"3"', "true", "0", "2147483648", "1e400"])
def test_nothing_else_is_one(text: str) -> None:
    with pytest.raises(ValidationError):
        BuildBody.model_validate_json(f'{{"base_version": {text}}}')


def test_the_schema_says_the_bounds() -> None:
    version, _null = BuildBody.model_json_schema()["properties"]["base_version"]["anyOf"]
    assert version == {"type": "integer", "minimum": 1, "maximum": 2**31 - 1}
