"""What the engine keeps of a build is JSON: who can write to the database still cannot make a worker run code."""

from __future__ import annotations

import json
from typing import Any

from dbos import Serializer

from app.errors import ScattermarkError

FAULT = "fault"  # the slug of an error that was not raised on purpose


class Replayed(ScattermarkError):
    """An error that a step raised in an earlier life of the worker."""

    def __init__(self, slug: str, detail: str, fields: dict[str, Any]) -> None:
        super().__init__(detail, **fields)
        self.slug = slug


class JsonSerializer(Serializer):
    """Values as JSON, errors by slug, detail and fields."""

    def name(self) -> str:
        """Name in the engine's tables."""
        return "scattermark-json-1"

    def serialize(self, data: Any) -> str:
        """A value, or an error, as text."""
        if isinstance(data, ScattermarkError):
            return json.dumps({"error": [data.slug, data.detail, data.fields]})
        if isinstance(data, BaseException):
            return json.dumps({"error": [FAULT, repr(data), {}]})
        return json.dumps({"value": data})

    def deserialize(cls, serialized_data: str) -> Any:  # noqa: N805 - as the engine names it
        """The value or the error of a text."""
        record = json.loads(serialized_data)
        return Replayed(*record["error"]) if "error" in record else record["value"]
