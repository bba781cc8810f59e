"""Papers that targets are printed on, and the module that suits each."""

from __future__ import annotations

from dataclasses import dataclass

from app.errors import InvalidInput


@dataclass(frozen=True)
class Paper:
    """A sheet, upright.

    Attributes
    ----------
    name : str
    width_mm, height_mm : float
        ISO 216; letter is ANSI/ASME Y14.1 A.
    u_mm : float
        Module of the largest plate that leaves a hand's margin: what is printed when none is named.
    """

    name: str
    width_mm: float
    height_mm: float
    u_mm: float


PAPERS = {
    paper.name: paper
    for paper in (
        Paper("A5", 148.0, 210.0, 9.0),
        Paper("A4", 210.0, 297.0, 14.0),
        Paper("A3", 297.0, 420.0, 20.0),
        Paper("A2", 420.0, 594.0, 28.0),
        Paper("A1", 594.0, 841.0, 40.0),
        Paper("A0", 841.0, 1189.0, 57.0),
        Paper("letter", 215.9, 279.4, 14.0),
    )
}


def paper_by_name(name: str) -> Paper:
    """The paper of that name.

    Raises
    ------
    InvalidInput
        For a name that is none of ``PAPERS``.
    """
    if name not in PAPERS:
        raise InvalidInput(f"unknown paper {name!r}; use one of {', '.join(PAPERS)}", size=name)
    return PAPERS[name]
