"""Who is ahead in a table of several methods."""

from __future__ import annotations

import pytest

from benchmarks.side_by_side import Figure, ahead, print_side_by_side


def cells(better: str | None, ours: float | None, theirs: float | None) -> dict[str, Figure]:
    values = {"default": ours, "paper": theirs}
    return {name: Figure("f", f"{value}", value, better) for name, value in values.items()}  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("better", "ours", "theirs", "winner"),
    [
        ("less", 1.0, 2.0, "default"),
        ("less", 2.0, 1.0, "paper"),
        ("more", 2.0, 1.0, "default"),
        ("more", 1.0, 2.0, "paper"),
        ("less", 1.0, 1.0, "equal"),
        ("less", 1.0, None, ""),
        (None, 1.0, 2.0, ""),
    ],
)
def test_the_better_figure_is_ahead_whose_ever_it_is(
    better: str | None, ours: float | None, theirs: float | None, winner: str
) -> None:
    assert ahead(cells(better, ours, theirs)) == winner


def test_what_is_printed_alike_is_equal() -> None:
    assert ahead({"a": Figure("f", "1.0", 1.01, "less"), "b": Figure("f", "1.0", 0.99, "less")}) == "equal"


def test_one_method_has_no_rival_and_a_missing_figure_is_a_dash(capsys: pytest.CaptureFixture[str]) -> None:
    print_side_by_side("t", {"alone": [Figure("first", "1", 1.0, "less")]})
    assert "ahead" not in capsys.readouterr().out
    print_side_by_side("t", {"one": [Figure("first", "1")], "other": [Figure("second", "2")]})
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in capsys.readouterr().out.splitlines()]
    assert ["first", "1", "-", ""] in rows and ["second", "-", "2", ""] in rows
