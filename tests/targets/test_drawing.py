import struct
import xml.etree.ElementTree as ElementTree

import cv2
import numpy as np
import pytest

from app.targets.digits import digits_of_code
from app.targets.drawing import BLACK_RGB, GREEN_RGB, RED_RGB, WHITE_RGB, plate_png, plate_rgb, plate_svg
from app.targets.layout import BASE_CELLS, DIGIT_CELLS, PLATE_SIDE_U, dot_centres_u

CODE = 389
SVG = "{http://www.w3.org/2000/svg}"


def expected_colours(code: int) -> dict[int, tuple[int, int, int]]:
    by_digit = {0: BLACK_RGB, 1: GREEN_RGB, 2: WHITE_RGB}
    colours = dict.fromkeys(BASE_CELLS, RED_RGB)
    return colours | {cell: by_digit[int(d)] for cell, d in zip(DIGIT_CELLS, digits_of_code(code), strict=True)}


@pytest.mark.parametrize("code", [CODE, 1, 177_146, 88_573])
@pytest.mark.parametrize("pixels_per_u", [2, 7, 30])
def test_colours_stand_at_the_dot_centres(code: int, pixels_per_u: int) -> None:
    plate = plate_rgb(code, pixels_per_u)
    assert plate.shape == (13 * pixels_per_u, 13 * pixels_per_u, 3)
    for cell, colour in expected_colours(code).items():
        x_u, y_u = dot_centres_u()[cell]
        column, row = int((x_u + PLATE_SIDE_U / 2) * pixels_per_u), int((PLATE_SIDE_U / 2 - y_u) * pixels_per_u)
        assert tuple(plate[row, column].tolist()) == colour


@pytest.mark.parametrize("pixels_per_u", [20, 21])
def test_dots_have_their_area_and_their_centroid(pixels_per_u: int) -> None:
    red = plate_rgb(CODE, pixels_per_u)[..., 0].astype(float) - BLACK_RGB[0]
    lit = red / (RED_RGB[0] - BLACK_RGB[0])
    x_u, y_u = dot_centres_u()[5]
    column, row = (x_u + PLATE_SIDE_U / 2) * pixels_per_u, (PLATE_SIDE_U / 2 - y_u) * pixels_per_u
    top, left, reach = round(row) - 30, round(column) - 30, 61
    window = lit[top : top + reach, left : left + reach]
    pixels = np.arange(reach) + 0.5
    # Eight bits per pixel leave 1/176 of a red step of rounding on each edge pixel.
    assert window.sum() / pixels_per_u**2 == pytest.approx(np.pi, rel=2e-3)
    assert (window.sum(axis=0) @ pixels) / window.sum() + left == pytest.approx(column, abs=1e-9)
    assert (window.sum(axis=1) @ pixels) / window.sum() + top == pytest.approx(row, abs=1e-9)


def test_border_is_black_one_u_around_the_dots() -> None:
    plate = plate_rgb(177_146, 10)
    border = np.ones(plate.shape[:2], dtype=bool)
    border[10:-10, 10:-10] = False
    assert (plate[border] == BLACK_RGB).all()


def test_png_holds_the_plate_its_margin_and_its_printed_size() -> None:
    png = plate_png(CODE, pixels_per_u=10, u_mm=14.0, margin_u=2)
    page = cv2.imdecode(np.frombuffer(png, dtype=np.uint8), cv2.IMREAD_COLOR_RGB)
    np.testing.assert_array_equal(page[20:-20, 20:-20], plate_rgb(CODE, 10))
    assert (page[:20] == 255).all() and (page[:, -20:] == 255).all()
    at = png.index(b"pHYs")
    pixels_per_m, _, unit = struct.unpack(">IIB", png[at + 4 : at + 13])
    assert unit == 1
    assert page.shape[1] / pixels_per_m == pytest.approx(17 * 0.014, abs=17 * 0.014 / pixels_per_m)


@pytest.mark.parametrize("margin_u", [0.0, 1.5])
@pytest.mark.parametrize("u_mm", [9.0, 14.0])
def test_svg_is_exact_in_millimetres(u_mm: float, margin_u: float) -> None:
    root = ElementTree.fromstring(plate_svg(CODE, u_mm, margin_u))
    side_mm = (PLATE_SIDE_U + 2 * margin_u) * u_mm
    assert root.get("width") == f"{side_mm:.4f}mm" and root.get("viewBox") == f"0 0 {side_mm:.4f} {side_mm:.4f}"
    circles = {(float(c.get("cx", "")), float(c.get("cy", ""))): c.get("fill", "") for c in root.iter(f"{SVG}circle")}
    assert {float(c.get("r", "")) for c in root.iter(f"{SVG}circle")} == {u_mm}
    coloured = {cell: rgb for cell, rgb in expected_colours(CODE).items() if rgb != BLACK_RGB}
    assert len(circles) == len(coloured)
    for cell, rgb in coloured.items():
        x_mm, y_mm = side_mm / 2 + dot_centres_u()[cell] * [u_mm, -u_mm]
        assert circles[(round(x_mm, 4), round(y_mm, 4))] == "#{:02x}{:02x}{:02x}".format(*rgb)
    plate = root.findall(f"{SVG}rect")[1]
    assert float(plate.get("x", "")) == margin_u * u_mm and float(plate.get("width", "")) == PLATE_SIDE_U * u_mm


def test_svg_names_the_code_where_there_is_room() -> None:
    assert ">389</text>" in plate_svg(CODE, margin_u=1.0)
    assert "<text" not in plate_svg(CODE, margin_u=0.5)


def test_impossible_plates_are_refused() -> None:
    with pytest.raises(ValueError, match="at least one pixel"):
        plate_rgb(CODE, 0)
    with pytest.raises(ValueError, match="lies within"):
        plate_rgb(3**11, 4)
    with pytest.raises(ValueError, match="positive"):
        plate_svg(CODE, 0.0)
