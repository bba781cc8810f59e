"""What a worker process does for sheets: plan, draw, read back."""

from __future__ import annotations

from collections.abc import Callable

from app.services.sheets.pdf import pdf_of_sheets
from app.services.sheets.read_back import read_back
from app.services.sheets.wish import SheetsWish, plan_sheets


def write_sheets(wish: SheetsWish, report: Callable[[int, int], None] | None = None) -> bytes:
    """Sheets as a PDF, each page of which was read back by the detector.

    Parameters
    ----------
    wish : SheetsWish
    report : callable, optional
        Told pages read back, and pages in all.

    Raises
    ------
    InvalidInput
        When the wish cannot be printed.
    SheetUnreadable
        When a page does not show what it should.
    """
    plan = plan_sheets(wish)
    pdf = pdf_of_sheets(plan)
    read_back(pdf, plan, report=report)
    return pdf
