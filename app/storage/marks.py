"""Dots marked by hand in a survey's photographs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np
from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from app.geometry.marks import Mark
from app.storage.models import PhotoMarkRow


class MarkRepository:
    """Marks of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def replace(self, survey_id: str, name: str, marks: Sequence[Mark]) -> None:
        """Make these the marks of a photograph; none removes all."""
        own = PhotoMarkRow.survey_id == survey_id, PhotoMarkRow.name == name
        self._session.execute(delete(PhotoMarkRow).where(*own))
        self._session.add_all(_row(survey_id, name, mark) for mark in marks)
        self._session.flush()

    def of_photo(self, survey_id: str, name: str) -> tuple[Mark, ...]:
        """The marks of a photograph by code and cell."""
        return self.of_survey(survey_id).get(name, ())

    def of_survey(self, survey_id: str) -> dict[str, tuple[Mark, ...]]:
        """The marks of each photograph that has some, by its name."""
        query = select(PhotoMarkRow).where(PhotoMarkRow.survey_id == survey_id)
        found: defaultdict[str, list[Mark]] = defaultdict(list)
        for row in self._session.scalars(query.order_by(PhotoMarkRow.code, PhotoMarkRow.cell)):
            found[row.name].append(_mark(row))
        return {name: tuple(marks) for name, marks in found.items()}


def every_mark(session: Session) -> Iterator[Mark]:
    """All marks of a database: of one that holds an arriving site.

    Raises
    ------
    ValueError
        For one that cannot be right.
    """
    return map(_mark, session.scalars(select(PhotoMarkRow)))


def _mark(row: PhotoMarkRow) -> Mark:
    return Mark(row.code, row.cell, np.array([row.x_px, row.y_px]), row.sigma_px)


def _row(survey_id: str, name: str, mark: Mark) -> PhotoMarkRow:
    x_px, y_px = mark.position_px.tolist()
    return PhotoMarkRow(
        survey_id=survey_id, name=name, code=mark.code, cell=mark.cell, x_px=x_px, y_px=y_px, sigma_px=mark.sigma_px
    )
