"""What the printer gets: measured in a fine raster of the page, without the detector."""

import cv2
import numpy as np
import numpy.typing as npt
import pypdfium2
import pytest

from app.services.sheets.pdf import pdf_of_sheets
from app.services.sheets.wish import SheetsWish, plan_sheets
from app.targets.drawing import GREEN_RGB, RED_RGB, cell_colours_rgb
from app.targets.layout import BASE_CELLS, PLATE_SIDE_U, dot_centres_u
from app.targets.sheet import BAR_MM, SIDE_MM

DPI = 300
MM_PER_INCH, POINTS_PER_INCH = 25.4, 72.0
LINK = "https://192.168.1.20:8443/#site_id=0193&code={code}"


def page_rgb(pdf: bytes, number: int = 0) -> npt.NDArray[np.uint8]:
    document = pypdfium2.PdfDocument(pdf)
    try:
        return np.array(document[number].render(scale=DPI / POINTS_PER_INCH, rev_byteorder=True).to_numpy())
    finally:
        document.close()


@pytest.mark.parametrize("size", ["A5", "A4", "letter"])
def test_pages_have_the_paper_s_size_and_dots_their_place_to_a_hundredth_of_a_millimetre(size: str) -> None:
    plan = plan_sheets(SheetsWish(codes=(389,), size=size))
    paper, u_mm = plan.layout.paper, plan.layout.u_mm
    pdf = pdf_of_sheets(plan)
    document = pypdfium2.PdfDocument(pdf)
    points = document[0].get_size()
    document.close()
    expected_points = np.array([paper.width_mm, paper.height_mm]) / MM_PER_INCH * POINTS_PER_INCH
    np.testing.assert_allclose(points, expected_points, atol=1e-3)
    rgb = page_rgb(pdf).astype(np.float64)
    px_per_mm = np.array([rgb.shape[1] / paper.width_mm, rgb.shape[0] / paper.height_mm])
    (place,) = plan.layout.places()
    for cell in BASE_CELLS:
        centre_mm = (dot_centres_u()[cell] * [1, -1] + PLATE_SIDE_U / 2) * u_mm + [place.x_mm, place.y_mm]
        found_mm, radius_mm = disc_at(rgb, centre_mm * px_per_mm, 1.4 * u_mm * px_per_mm[0])
        assert np.abs(found_mm / px_per_mm - centre_mm).max() < 0.02
        assert radius_mm / px_per_mm.mean() == pytest.approx(u_mm, abs=0.02)


def disc_at(
    rgb: npt.NDArray[np.float64], centre_px: npt.NDArray[np.float64], reach_px: float
) -> tuple[npt.NDArray[np.float64], float]:
    """Centroid (pixel edges count from 0) and radius of the red in a window, px."""
    left, top = (int(edge) for edge in centre_px - reach_px)
    size = int(2 * reach_px)
    red = rgb[top : top + size, left : left + size, 0]
    lit = np.clip((red - 24.0) / (RED_RGB[0] - 24.0), 0.0, 1.0)
    at = np.arange(size) + 0.5
    centroid = np.array([(lit.sum(axis=0) @ at) / lit.sum() + left, (lit.sum(axis=1) @ at) / lit.sum() + top])
    return centroid, float(np.sqrt(lit.sum() / np.pi))


def test_check_bars_measure_a_hundred_millimetres_both_ways() -> None:
    plan = plan_sheets(SheetsWish(count=1))
    rgb = page_rgb(pdf_of_sheets(plan))
    dark = rgb.max(axis=2) < 128
    px_per_mm = DPI / MM_PER_INCH
    across = dark[int((297 - 40) * px_per_mm) : int((297 - 27) * px_per_mm), int((SIDE_MM - 2) * px_per_mm) :]
    assert longest_run(across) / px_per_mm == pytest.approx(BAR_MM, abs=0.3)
    along = dark[:, int(7 * px_per_mm) : int(9 * px_per_mm)]
    assert longest_run(along.T) / px_per_mm == pytest.approx(BAR_MM, abs=0.3)


def longest_run(dark: npt.NDArray[np.bool_]) -> int:
    longest = 0
    for row in dark:
        edges = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]]).astype(np.int8)))
        longest = max(longest, int((edges[1::2] - edges[::2]).max(initial=0)))
    return longest


def test_a_sheet_names_its_code_which_way_is_up_and_where_it_belongs() -> None:
    pdf = pdf_of_sheets(plan_sheets(SheetsWish(codes=(389, 889), title="Lecture hall 4", link=LINK)))
    document = pypdfium2.PdfDocument(pdf)
    texts = [document[number].get_textpage().get_text_bounded() for number in range(2)]
    document.close()
    assert "389" in texts[0] and "889" in texts[1]
    for text in texts:
        assert "UP" in text and "Lecture hall 4" in text and "u = 14 mm" in text and "100 mm across" in text


@pytest.mark.parametrize("link", [LINK, None])
def test_the_qr_code_leads_to_the_site_and_the_code(link: str | None) -> None:
    plan = plan_sheets(SheetsWish(codes=(389,), link=link))
    rgb = page_rgb(pdf_of_sheets(plan))
    text, _, _ = cv2.QRCodeDetector().detectAndDecode(rgb[int(0.7 * len(rgb)) :])
    assert text == ("scattermark:golay/389" if link is None else LINK.replace("{code}", "389"))


def test_all_four_inks_are_patches_and_the_plate_s_colours_are_the_printed_ones() -> None:
    plan = plan_sheets(SheetsWish(codes=(889,)))
    rgb = page_rgb(pdf_of_sheets(plan))
    seen = {tuple(colour) for colour in rgb[int(0.95 * len(rgb)) :].reshape(-1, 3).tolist()}
    assert {RED_RGB, GREEN_RGB, (238, 238, 232), (24, 24, 26)} <= seen
    place, u_mm = plan.layout.places()[0], plan.layout.u_mm
    for centre_u, colour in zip(dot_centres_u(), cell_colours_rgb(889).tolist(), strict=True):
        x_mm, y_mm = (centre_u * [1, -1] + PLATE_SIDE_U / 2) * u_mm + [place.x_mm, place.y_mm]
        assert rgb[int(y_mm * DPI / MM_PER_INCH), int(x_mm * DPI / MM_PER_INCH)].tolist() == colour


def test_the_same_wish_gives_the_same_file() -> None:
    plan = plan_sheets(SheetsWish(count=2, size="A5"))
    assert pdf_of_sheets(plan) == pdf_of_sheets(plan)


def test_print_dialogues_are_told_not_to_fit_the_page() -> None:
    assert b"/PrintScaling /None" in pdf_of_sheets(plan_sheets(SheetsWish(count=1)))
