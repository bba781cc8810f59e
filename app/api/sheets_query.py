"""Which sheets are wanted, as the query says it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Query, Request

from app.api.dependencies import Id, ReadSession
from app.api.schemas.sites import FamilyName
from app.api.schemas.texts import Text
from app.api.security import Reading
from app.services.sheets.site import wish_for_site
from app.services.sheets.wish import MOST_TARGETS, SheetsWish, codes_of_text

CODES = "Codes and ranges of codes, separated by commas; without them `count` codes are chosen."
CODES_PATTERN = r"^\d{1,6}(-\d{1,6})?(,\d{1,6}(-\d{1,6})?)*$"
SITE = "Family, module, name and QR codes are this site's, and no code is chosen that hangs there already."
SIZE_PATTERN = "^(A[0-5]|letter)$"

UMm = Annotated[float, Query(gt=0, le=1000, allow_inf_nan=False, description="Module, millimetres.")]


@dataclass(frozen=True)
class TargetsWanted:
    """Which targets of which family, and for which site."""

    family: FamilyName
    codes: tuple[int, ...]
    count: int | None
    site_id: str | None


@dataclass(frozen=True)
class PrintWanted:
    """On which paper, how large, under which title."""

    size: str
    u_mm: float | None
    title: str


def targets_wanted(
    family: FamilyName = "golay",
    codes: Annotated[
        str | None, Query(max_length=10_000, pattern=CODES_PATTERN, description=CODES, examples=["389,400-420"])
    ] = None,
    count: Annotated[int | None, Query(ge=1, le=MOST_TARGETS, description="How many codes to choose.")] = None,
    site_id: Annotated[Id | None, Query(description=SITE)] = None,
) -> TargetsWanted:
    """The part of the query that says which targets."""
    return TargetsWanted(family, codes_of_text(codes or ""), count, site_id)


def print_wanted(
    size: Annotated[str, Query(pattern=SIZE_PATTERN, description="A0 ... A5, or letter.")] = "A4",
    u_mm: UMm | None = None,
    title: Text | None = None,
) -> PrintWanted:
    """The part of the query that says how they are printed."""
    return PrintWanted(size, u_mm, title or "")


def sheets_wish(
    request: Request,
    session: ReadSession,
    principal: Reading,
    targets: Annotated[TargetsWanted, Depends(targets_wanted)],
    paper: Annotated[PrintWanted, Depends(print_wanted)],
) -> SheetsWish:
    """The sheets of a request.

    Raises
    ------
    InvalidInput
        When the parameters contradict each other.
    NotFound
        When there is no such site, or it is none of the key's.
    """
    wish = SheetsWish(targets.family, targets.codes, targets.count, paper.size, paper.u_mm, paper.title)
    if targets.site_id is None:
        return wish
    principal.site(targets.site_id)
    return wish_for_site(session, targets.site_id, wish, str(request.base_url).rstrip("/"))


WantedSheets = Annotated[SheetsWish, Depends(sheets_wish)]
