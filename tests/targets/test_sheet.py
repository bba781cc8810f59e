import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import InvalidInput
from app.targets.layout import PLATE_SIDE_U
from app.targets.paper import PAPERS, paper_by_name
from app.targets.sheet import EDGE_MM, FOOT_MM, GAP_MM, SIDE_MM, sheet_layout


@pytest.mark.parametrize(("size", "u_mm"), [("A5", 9.0), ("A4", 14.0), ("A3", 20.0), ("letter", 14.0)])
def test_each_paper_takes_one_plate_of_its_usual_module(size: str, u_mm: float) -> None:
    layout = sheet_layout(paper_by_name(size))
    assert (layout.u_mm, layout.per_sheet) == (u_mm, 1)


PAPER_NAMES = st.sampled_from(sorted(PAPERS))


@given(PAPER_NAMES, st.floats(1.0, 60.0))
def test_a_plate_too_large_is_refused_with_the_largest_that_fits(size: str, u_mm: float) -> None:
    paper = paper_by_name(size)
    with pytest.raises(InvalidInput) as refusal:
        sheet_layout(paper, paper.width_mm / PLATE_SIDE_U + u_mm)
    largest_u_mm = refusal.value.fields["largest_u_mm"]
    assert sheet_layout(paper, largest_u_mm).per_sheet >= 1
    with pytest.raises(InvalidInput):
        sheet_layout(paper, largest_u_mm + 0.11)


@given(PAPER_NAMES, st.floats(0.02, 1.0))
def test_plates_their_labels_and_their_gaps_lie_on_the_paper_and_not_on_each_other(size: str, share: float) -> None:
    paper = paper_by_name(size)
    layout = sheet_layout(paper, share * paper.u_mm)
    width_mm, height_mm = layout.cut_size_mm
    places = layout.places()
    assert layout.gap_mm >= GAP_MM - 1e-9 and len(places) == layout.per_sheet
    for place in places:
        left_mm, top_mm = place.x_mm - layout.gap_mm, place.y_mm - layout.gap_mm
        assert left_mm >= SIDE_MM - 1e-9 and left_mm + width_mm <= paper.width_mm - SIDE_MM + 1e-9
        assert top_mm >= EDGE_MM - 1e-9 and top_mm + height_mm <= paper.height_mm - EDGE_MM - FOOT_MM + 1e-9
    corners = np.array([[place.x_mm, place.y_mm] for place in places])
    columns, rows = np.unique(corners[:, 0].round(6)), np.unique(corners[:, 1].round(6))
    assert len(columns) * len(rows) == len(places)
    assert np.diff(columns).min(initial=width_mm) >= width_mm - 1e-5
    assert np.diff(rows).min(initial=height_mm) >= height_mm - 1e-5


def test_codes_fill_sheet_after_sheet() -> None:
    layout = sheet_layout(paper_by_name("A4"), 5.0)
    assert layout.per_sheet == 4
    assert layout.sheets([5, 6, 7, 8, 9]) == ((5, 6, 7, 8), (9,))


@pytest.mark.parametrize("u_mm", [0.0, -1.0, float("nan"), float("inf")])
def test_a_module_that_is_no_length_is_refused(u_mm: float) -> None:
    with pytest.raises(InvalidInput, match="positive"):
        sheet_layout(paper_by_name("A4"), u_mm)


def test_an_unknown_paper_is_refused_with_those_there_are() -> None:
    with pytest.raises(InvalidInput, match="A4, A3"):
        paper_by_name("B5")
