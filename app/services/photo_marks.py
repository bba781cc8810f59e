"""The story of marks: a person says where dots are in a photograph, the next build takes them as measured."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy.orm import Session

from app.errors import InvalidInput
from app.geometry.marks import Mark
from app.storage.marks import MarkRepository
from app.storage.records import StoredPhoto
from app.storage.sites import SiteRepository
from app.storage.surveys import SurveyRepository
from app.targets.family import family_by_name

EDGE_PX = 0.5  # a photograph begins half a pixel before its first pixel's centre


def put_marks(session: Session, survey_id: str, name: str, marks: Sequence[Mark]) -> tuple[Mark, ...]:
    """Replace the marks of a photograph.

    Raises
    ------
    NotFound
        When there is no such photograph.
    InvalidInput
        For a code that the site has not, a dot that is marked twice or outside of the photograph.
    """
    photo = SurveyRepository(session).photo(survey_id, name)
    site_id = SurveyRepository(session).get(survey_id).site_id
    family = family_by_name(SiteRepository(session).get(site_id).code_family)
    known: set[tuple[int, int]] = set()
    for index, mark in enumerate(marks):
        if not family.contains(mark.code):
            raise _refusal(index, "code", f"{mark.code} is no code of the site's family {family.name}")
        if (mark.code, mark.cell) in known:
            raise _refusal(index, "dot", f"this dot of target {mark.code} is marked twice")
        _check_inside(index, mark, photo)
        known.add((mark.code, mark.cell))
    MarkRepository(session).replace(survey_id, name, marks)
    return get_marks(session, survey_id, name)


def get_marks(session: Session, survey_id: str, name: str) -> tuple[Mark, ...]:
    """The marks of a photograph by code and cell.

    Raises
    ------
    NotFound
        When there is no such photograph.
    """
    SurveyRepository(session).photo(survey_id, name)
    return MarkRepository(session).of_photo(survey_id, name)


def _check_inside(index: int, mark: Mark, photo: StoredPhoto) -> None:
    sizes_px = photo.identity.width_px, photo.identity.height_px
    for field, position_px, size_px in zip(("x_px", "y_px"), mark.position_px.tolist(), sizes_px, strict=True):
        if not -EDGE_PX <= position_px <= size_px - EDGE_PX:
            raise _refusal(index, field, f"{position_px:g} px is outside of the photograph ({size_px} px)")


def _refusal(index: int, field: str, problem: str) -> InvalidInput:
    return InvalidInput(f"nothing was stored; mark {index + 1}: {problem}", field=f"marks.{index}.{field}")
