import pytest

from app.errors import InvalidInput
from app.services.sheets.wish import SheetsWish, codes_of_text, plan_sheets


def test_codes_are_told_singly_and_in_ranges() -> None:
    assert codes_of_text("") == ()
    assert codes_of_text("389, 400-402,7") == (389, 400, 401, 402, 7)


@pytest.mark.parametrize("text", ["x", "0", "5-3", "177147", "3-", "1;2", "-4"])
def test_what_names_no_codes_is_refused(text: str) -> None:
    with pytest.raises(InvalidInput, match="names no codes"):
        codes_of_text(text)


@pytest.mark.parametrize(
    ("wish", "word"),
    [
        ({}, "how many"),
        ({"codes": (389,), "count": 3}, "not both"),
        ({"count": 3, "link": "https://host/"}, "{code}"),
    ],
)
def test_contradictory_wishes_are_refused(wish: dict[str, object], word: str) -> None:
    with pytest.raises(InvalidInput, match=word):
        SheetsWish(**wish)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("wish", "word"),
    [
        (SheetsWish(codes=(388,)), "no codes of the family golay: 388"),
        (SheetsWish(codes=(389, 389)), "come twice: 389"),
        (SheetsWish(family="full", count=1001), "too many"),
        (SheetsWish(count=1, u_mm=20.0), "too large for A4; up to u = 14"),
        (SheetsWish(count=1, size="B4"), "unknown paper"),
    ],
)
def test_what_cannot_be_printed_is_refused_with_what_can(wish: SheetsWish, word: str) -> None:
    with pytest.raises(InvalidInput, match=word):
        plan_sheets(wish)


def test_a_long_title_is_cut_and_its_unseen_characters_are_shown() -> None:
    plan = plan_sheets(SheetsWish(count=1, title="hall\u202e " + "x" * 200))
    assert len(plan.title) == 60 and "\u202e" not in plan.title
