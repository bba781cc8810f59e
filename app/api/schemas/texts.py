"""Texts that people write: what they may hold, said alike by the check and by the schema."""

from __future__ import annotations

import re
from typing import Annotated

from pydantic import AfterValidator, Field, StringConstraints

# Control characters, and those that turn the direction of reading, make a name look like another one.
_UNSEEN = r"\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069"
NAME = re.compile(rf"^[^{_UNSEEN}]*[^\s{_UNSEEN}][^{_UNSEEN}]*$")
NOTE = re.compile(r"^[^\x00]*$")  # Postgres keeps no NUL


def _name(text: str) -> str:
    if not NAME.fullmatch(text):
        raise ValueError("is empty or has characters that cannot be seen: write letters, digits, signs and spaces")
    return text


def _note(text: str) -> str:
    if not NOTE.fullmatch(text):
        raise ValueError("has a NUL character: leave it out")
    return text


Text = Annotated[
    str,
    StringConstraints(strip_whitespace=True, max_length=200),
    AfterValidator(_name),
    Field(json_schema_extra={"pattern": NAME.pattern}),
]
LongText = Annotated[
    str,
    StringConstraints(max_length=10_000),
    AfterValidator(_note),
    Field(json_schema_extra={"pattern": NOTE.pattern}),
]
