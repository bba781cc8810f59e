"""What somebody wants printed, and the sheets that answer it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from app.errors import InvalidInput
from app.services.reporting.text import readable
from app.targets.choosing import choose_codes
from app.targets.digits import CODE_COUNT
from app.targets.family import CodeFamily, family_by_name
from app.targets.paper import paper_by_name
from app.targets.sheet import SheetLayout, sheet_layout

MOST_TARGETS = 1000  # in one file: the whole of the family golay, and some
CODE_RANGE = re.compile(r"(\d{1,6})(?:-(\d{1,6}))?", re.ASCII)
LONGEST_TITLE = 60  # characters that a footer shows


@dataclass(frozen=True)
class SheetsWish:
    """Sheets that are asked for.

    Attributes
    ----------
    family : str
        Code family.
    codes : tuple of int
        What to print; empty: ``count`` of them are chosen.
    count : int or None
        How many to choose.
    size : str
        Name of the paper.
    u_mm : float or None
        Module; the paper's own when None.
    title : str
        The site's name, or whatever shall stand on each sheet.
    link : str or None
        Where a target's QR code leads; ``{code}`` in it stands for the code.
    taken : tuple of int
        Codes that hang there already.
    """

    family: str = "golay"
    codes: tuple[int, ...] = ()
    count: int | None = None
    size: str = "A4"
    u_mm: float | None = None
    title: str = ""
    link: str | None = None
    taken: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if bool(self.codes) == (self.count is not None):
            raise InvalidInput("say which codes to print (codes), or how many (count), and not both", field="codes")
        if self.link is not None and "{code}" not in self.link:
            raise InvalidInput(
                "a link for QR codes says with {code} where the code stands in it", field="link", link=self.link
            )


@dataclass(frozen=True)
class SheetsPlan:
    """Sheets that can be printed.

    Attributes
    ----------
    family : CodeFamily
    codes : tuple of int
        In the order of the sheets.
    layout : SheetLayout
    title : str
    link : str or None
    """

    family: CodeFamily
    codes: tuple[int, ...]
    layout: SheetLayout
    title: str
    link: str | None

    @property
    def sheets(self) -> tuple[tuple[int, ...], ...]:
        """The codes of each sheet."""
        return self.layout.sheets(self.codes)

    def qr_text(self, code: int) -> str:
        """What a target's QR code says."""
        if self.link is None:
            return f"scattermark:{self.family.name}/{code}"
        return self.link.replace("{code}", str(code))


def codes_of_text(text: str) -> tuple[int, ...]:
    """Codes of a list such as ``389,400-420``.

    Raises
    ------
    InvalidInput
        For what is no number, a range that runs backwards, or numbers that no code has.
    """
    codes: list[int] = []
    for part in filter(None, text.split(",")):
        found = CODE_RANGE.fullmatch(part.strip())
        start, stop = (0, 0) if found is None else (int(found[1]), int(found[2] or found[1]))
        if not 0 < start <= stop < CODE_COUNT:
            raise InvalidInput(
                f"{part!r} names no codes: write numbers from 1 to {CODE_COUNT - 1} or ranges such as 400-420",
                field="codes",
                codes=part,
            )
        codes.extend(range(start, stop + 1))
    return tuple(codes)


def plan_sheets(wish: SheetsWish) -> SheetsPlan:
    """What will stand on which sheet.

    Raises
    ------
    InvalidInput
        For codes that the family does not hold or that come twice, too many of them, or a plate larger than the paper.
    """
    family = family_by_name(wish.family)
    layout = sheet_layout(paper_by_name(wish.size), wish.u_mm)
    wanted = len(wish.codes) if wish.count is None else wish.count
    if wanted > MOST_TARGETS:
        raise InvalidInput(
            f"{wanted} targets are too many for one file; print up to {MOST_TARGETS} at a time",
            field="codes",
            most=MOST_TARGETS,
        )
    codes = wish.codes if wish.count is None else choose_codes(family, wish.count, wish.taken)
    _check(family, codes)
    return SheetsPlan(family, codes, layout, readable(wish.title)[:LONGEST_TITLE], wish.link)


def _check(family: CodeFamily, codes: tuple[int, ...]) -> None:
    foreign = sorted({code for code in codes if not family.contains(code)})
    if foreign:
        raise InvalidInput(
            f"no codes of the family {family.name}: {', '.join(map(str, foreign))}; code 0 is never printed, "
            "and only the family full holds every other number up to 177146",
            field="codes",
            codes=foreign,
        )
    repeated = sorted({code for code in codes if codes.count(code) > 1})
    if repeated:
        raise InvalidInput(
            f"codes that come twice: {', '.join(map(str, repeated))}; two targets of one code in a site cannot be told "
            "from each other",
            field="codes",
            codes=repeated,
        )
