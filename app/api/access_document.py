"""OpenAPI's word on keys: which scope opens a call, and the problems of whoever has none."""

from __future__ import annotations

from typing import Any

from app.api.problems import problems

REFUSALS = (401, 403, 429)


def describe_access(document: dict[str, Any]) -> None:
    """Complete an OpenAPI document in place.

    The framework lists the scopes of a call as if all were needed; one of them is enough, and ``admin`` always is.
    """
    for methods in document["paths"].values():
        for call in methods.values():
            if call.get("security"):
                call["security"] = [
                    {name: [scope]} for entry in call["security"] for name, scopes in entry.items() for scope in scopes
                ]
                described = {str(status): answer for status, answer in problems(*REFUSALS).items()}
                call["responses"] = {**call["responses"], **described}
