from dataclasses import replace

import pytest

from app.errors import SheetUnreadable
from app.services.sheets.pdf import pdf_of_sheets
from app.services.sheets.read_back import read_back
from app.services.sheets.wish import SheetsWish, plan_sheets
from app.services.sheets.work import write_sheets
from app.targets.sheet import Place, SheetLayout


def test_all_codes_of_golay_are_printed_and_read() -> None:
    told: list[tuple[int, int]] = []
    pdf = write_sheets(SheetsWish(count=728, u_mm=4.0), lambda done, total: told.append((done, total)))
    assert pdf.startswith(b"%PDF") and told[-1] == (len(told), len(told))
    assert len(told) * plan_sheets(SheetsWish(count=1, u_mm=4.0)).layout.per_sheet >= 728


@pytest.mark.parametrize("size", ["A5", "A3", "A0", "letter"])
@pytest.mark.parametrize("family", ["golay", "full"])
def test_every_paper_reads_back(size: str, family: str) -> None:
    assert write_sheets(SheetsWish(family=family, count=1, size=size, title="hall"))


def test_a_sheet_that_shows_another_code_is_not_delivered() -> None:
    plan = plan_sheets(SheetsWish(codes=(389,)))
    with pytest.raises(SheetUnreadable, match=r"\[389\] instead of \[889\]"):
        read_back(pdf_of_sheets(plan), replace(plan, codes=(889,)))


def test_a_target_that_stands_elsewhere_is_not_delivered() -> None:
    class Moved(SheetLayout):
        def places(self) -> tuple[Place, ...]:
            (place,) = super().places()
            return (Place(place.x_mm, place.y_mm + 2.0),)

    plan = plan_sheets(SheetsWish(codes=(389,)))
    moved = Moved(*(getattr(plan.layout, name) for name in ("paper", "u_mm", "columns", "rows", "gap_mm")))
    with pytest.raises(SheetUnreadable, match="mm from its place"):
        read_back(pdf_of_sheets(replace(plan, layout=moved)), plan)


def test_a_page_too_few_is_not_delivered() -> None:
    plan = plan_sheets(SheetsWish(count=2))
    with pytest.raises(SheetUnreadable, match="1 pages instead of 2"):
        read_back(pdf_of_sheets(replace(plan, codes=plan.codes[:1])), plan)
