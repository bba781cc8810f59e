"""Ground of all bodies and answers."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from app.services.capture_time import iso_of


def _without_point(value: Any) -> Any:
    return int(value) if isinstance(value, float) and value.is_integer() else value


MOST_VALUES = 10_000  # of a body: the longest is a build's list of photographs to leave out

# Of JSON bodies: true is no number and "4.5" is text. The bounds of a whole number stand beside its strictness, before
# WHOLE: only from there do they reach the schema.
WHOLE = BeforeValidator(_without_point)  # to JSON 3.0 is a whole number
Finite = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Truth = Annotated[bool, Field(strict=True)]
Vector3 = Annotated[list[float], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[float], Field(min_length=4, max_length=4, description="x, y, z, w")]


class Body(BaseModel):
    """A request's body; a misspelt field is an error, not a default."""

    model_config = ConfigDict(extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _of_reasonable_size(cls, data: Any) -> Any:
        """Looked at before its fields are, for each that is wrong takes longer to be told than to be sent."""
        if _has_more_values(data, MOST_VALUES):
            raise ValueError(f"has more than {MOST_VALUES} values; no call takes as many")
        return data


def _has_more_values(data: Any, most: int) -> bool:
    """Whether there are more fields and items than that, at all depths together."""
    count, waiting = 0, [data]
    while waiting:
        item = waiting.pop()
        parts = item.values() if isinstance(item, dict) else item if isinstance(item, list) else ()
        count += len(parts)
        if count > most:
            return True
        waiting.extend(parts)
    return False


class Listing(BaseModel):
    """Ground of the lists."""

    next_cursor: str | None = Field(description="Give it as cursor to get the next page; null at the end.")


def time_of(seconds: float) -> str:
    """ISO 8601 in UTC."""
    return iso_of(seconds)


def numbers_of(array: npt.NDArray[np.float64]) -> list[float]:
    """A vector as JSON."""
    return [float(value) for value in array]
