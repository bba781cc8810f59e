"""Dots that a person marked in a photograph."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from pydantic import BaseModel, Field

from app.api.schemas.common import WHOLE, Body, Finite
from app.geometry.marks import HAND_SIGMA_PX, Mark
from app.targets.digits import CODE_COUNT
from app.targets.layout import BASE_CELLS, BASE_NAMES, CELLS_PER_SIDE, cell_of_dot

GREATEST_PX = 1e5  # beyond any photograph
MOST_MARKS = 1000  # of a photograph: by then it is not worth the labour


class MarkBody(Body):
    """The centre of one dot, as sent and as shown."""

    code: Annotated[int, Field(strict=True, ge=0, lt=CODE_COUNT), WHOLE]
    dot: Annotated[str, Field(pattern=r"^(?:[A-E]|r[0-3]c[0-3])$", description="A ... E, or r0c0 ... r3c3")]
    x_px: Annotated[Finite, Field(ge=-1.0, le=GREATEST_PX, description="As the sensor's rows lie, not turned.")]
    y_px: Annotated[Finite, Field(ge=-1.0, le=GREATEST_PX)]
    sigma_px: Annotated[Finite, Field(gt=0, le=100.0, description="Of each coordinate.")] = HAND_SIGMA_PX

    def to_domain(self) -> Mark:
        """The mark as services know it."""
        cell = cell_of_dot(self.dot)
        assert cell is not None  # the pattern leaves out the plate's middle, which is no dot
        return Mark(self.code, cell, np.array([self.x_px, self.y_px]), self.sigma_px)

    @classmethod
    def of(cls, mark: Mark) -> MarkBody:
        """The row of a mark."""
        x_px, y_px = mark.position_px.tolist()
        return cls(code=mark.code, dot=_name_of_cell(mark.cell), x_px=x_px, y_px=y_px, sigma_px=mark.sigma_px)


class MarksBody(Body):
    """All marks of a photograph."""

    marks: Annotated[tuple[MarkBody, ...], Field(max_length=MOST_MARKS)]

    def to_domain(self) -> tuple[Mark, ...]:
        """The marks as services know them."""
        return tuple(mark.to_domain() for mark in self.marks)


class MarksAnswer(BaseModel):
    """The marks of a photograph by code and cell."""

    marks: list[MarkBody]

    @classmethod
    def of(cls, marks: Sequence[Mark]) -> MarksAnswer:
        """The answer for marks."""
        return cls(marks=[MarkBody.of(mark) for mark in marks])


def _name_of_cell(cell: int) -> str:
    if cell in BASE_CELLS:
        return BASE_NAMES[BASE_CELLS.index(cell)]
    return f"r{cell // CELLS_PER_SIDE}c{cell % CELLS_PER_SIDE}"
