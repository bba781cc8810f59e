"""One target on a sheet: the plate, its label, its cut marks."""

from __future__ import annotations

import segno

from app.services.reporting.pdf.fonts import BOLD
from app.services.sheets.pen import Pen, Rgb, Writing, width_mm_of
from app.services.sheets.wish import SheetsPlan
from app.targets.drawing import BLACK_RGB, LABEL_RGB, cell_colours_rgb
from app.targets.layout import DOT_RADIUS_U, PLATE_SIDE_U, dots_from_corner_u
from app.targets.sheet import Place

INK_RGB = (24, 24, 26)
CODE_SHARE = 0.52  # of the label's height: the code's letters
NOTE_MM, NOTE_LINE_MM = 2.2, 3.5  # smallest writing that every office printer shows; from line to line
QR_SHARE = 0.4  # of a small plate's width
ARROW_ROOM = 1.3  # of the arrow with its gaps and its word, in heights of the digits
MARK_MM, MARK_WIDTH_MM = 4.0, 0.15  # cut marks
QR_QUIET_MODULES = 2  # of white around a QR code, beside the paper's own
PADDING_MM = 2.0
ARROW_WIDTH, ARROW_HEAD, ARROW_SHAFT = 0.42, 0.45, 0.16  # shares of the arrow's height


def draw_target(pen: Pen, plan: SheetsPlan, code: int, place: Place) -> None:
    """A plate at its place with all that belongs to it."""
    _draw_plate(pen, plan.layout.u_mm, code, place)
    _draw_label(pen, plan, code, place)
    _draw_cut_marks(pen, plan, place)


def _draw_plate(pen: Pen, u_mm: float, code: int, place: Place) -> None:
    side_mm = PLATE_SIDE_U * u_mm
    pen.rectangle((place.x_mm, place.y_mm, side_mm, side_mm), BLACK_RGB)
    for (x_mm, y_mm), colour in zip(
        (dots_from_corner_u() * u_mm).tolist(), cell_colours_rgb(code).tolist(), strict=True
    ):
        rgb: Rgb = (colour[0], colour[1], colour[2])
        if rgb == BLACK_RGB:
            continue  # a black dot is the plate itself
        pen.disc((place.x_mm + x_mm, place.y_mm + y_mm), DOT_RADIUS_U * u_mm, rgb)


def _draw_label(pen: Pen, plan: SheetsPlan, code: int, place: Place) -> None:
    """The code in large digits, which way is up, what it belongs to, and the QR code."""
    layout = plan.layout
    top_mm = place.y_mm + layout.plate_mm + PADDING_MM
    height_mm = layout.label_mm - PADDING_MM
    qr_mm = min(height_mm, QR_SHARE * layout.plate_mm)
    room_mm = layout.plate_mm - qr_mm - PADDING_MM
    digits_mm = _digits_height_mm(str(code), CODE_SHARE * height_mm, room_mm)
    digits = Writing(digits_mm, INK_RGB, BOLD)
    base_mm = top_mm + digits_mm
    pen.text((place.x_mm, base_mm), str(code), digits)
    _draw_arrow(pen, (place.x_mm + width_mm_of(str(code), digits) + digits_mm / 4, top_mm), digits_mm)
    for line, note in enumerate((plan.title, f"{plan.family.name}  u = {layout.u_mm:g} mm")):
        _note(pen, (place.x_mm, base_mm + NOTE_LINE_MM * (line + 1)), note, room_mm)
    _draw_qr(pen, plan.qr_text(code), (place.x_mm + layout.plate_mm - qr_mm, top_mm), qr_mm)


def _digits_height_mm(code: str, wanted_mm: float, room_mm: float) -> float:
    """Height of the digits, so that they and the arrow beside them fit."""
    width_mm = width_mm_of(code, Writing(wanted_mm, INK_RGB, BOLD)) + ARROW_ROOM * wanted_mm
    return wanted_mm * min(1.0, room_mm / width_mm)


def _note(pen: Pen, at_mm: tuple[float, float], text: str, room_mm: float) -> None:
    """A small line, shortened to its room."""
    writing = Writing(NOTE_MM, LABEL_RGB)
    shown = text
    while shown and width_mm_of(shown, writing) > room_mm:
        shown = f"{shown.removesuffix('…')[:-1]}…" if len(shown) > 1 else ""
    pen.text(at_mm, shown, writing)


def _draw_arrow(pen: Pen, top_left_mm: tuple[float, float], height_mm: float) -> None:
    """Towards the upper edge, with the word."""
    x_mm, y_mm = top_left_mm
    half_mm, head_mm, shaft_mm = (share * height_mm for share in (ARROW_WIDTH / 2, ARROW_HEAD, ARROW_SHAFT))
    middle_mm = x_mm + half_mm
    pen.polygon(((middle_mm, y_mm), (x_mm, y_mm + head_mm), (x_mm + 2 * half_mm, y_mm + head_mm)), INK_RGB)
    pen.rectangle((middle_mm - shaft_mm / 2, y_mm + head_mm, shaft_mm, height_mm - head_mm), INK_RGB)
    pen.text((x_mm + 2 * half_mm + PADDING_MM / 2, y_mm + height_mm), "UP", Writing(height_mm / 3, INK_RGB))


def _draw_qr(pen: Pen, text: str, top_left_mm: tuple[float, float], side_mm: float) -> None:
    matrix = segno.make_qr(text, error="m").matrix
    module_mm = side_mm / (len(matrix) + 2 * QR_QUIET_MODULES)
    left_mm, top_mm = (edge_mm + QR_QUIET_MODULES * module_mm for edge_mm in top_left_mm)
    boxes_mm = [
        (left_mm + first * module_mm, top_mm + row * module_mm, length * module_mm, module_mm)
        for row, modules in enumerate(matrix)
        for first, length in _runs(modules)
    ]
    pen.rectangles(boxes_mm, INK_RGB)


def _runs(modules: bytearray) -> list[tuple[int, int]]:
    """Dark modules of a row as (first, length): one rectangle each leaves no hairlines between modules."""
    runs: list[tuple[int, int]] = []
    for index, dark in enumerate(modules):
        if not dark:
            continue
        if runs and sum(runs[-1]) == index:
            runs[-1] = (runs[-1][0], runs[-1][1] + 1)
        else:
            runs.append((index, 1))
    return runs


def _draw_cut_marks(pen: Pen, plan: SheetsPlan, place: Place) -> None:
    """Two strokes at each corner, outside of what is cut out."""
    layout = plan.layout
    width_mm, height_mm = layout.cut_size_mm
    left_mm, top_mm = place.x_mm - layout.gap_mm, place.y_mm - layout.gap_mm
    reach_mm = min(MARK_MM, layout.gap_mm)
    for x_mm, outward in ((left_mm, -1.0), (left_mm + width_mm, 1.0)):
        for y_mm, away in ((top_mm, -1.0), (top_mm + height_mm, 1.0)):
            pen.line((x_mm, y_mm), (x_mm + outward * reach_mm, y_mm), MARK_WIDTH_MM, LABEL_RGB)
            pen.line((x_mm, y_mm), (x_mm, y_mm + away * reach_mm), MARK_WIDTH_MM, LABEL_RGB)
