"""What stands on a sheet beside its targets: check bars along and across the paper, colour patches, what it is."""

from __future__ import annotations

from app.services.reporting.software import this_software
from app.services.sheets.pen import Pen, Rgb, Writing
from app.services.sheets.target import INK_RGB, draw_target
from app.services.sheets.wish import SheetsPlan
from app.targets.drawing import BLACK_RGB, GREEN_RGB, LABEL_RGB, RED_RGB, WHITE_RGB
from app.targets.sheet import BAR_MM, EDGE_MM, FOOT_MM, PATCH_MM, SIDE_MM

TICK_MM, MINOR_TICK_MM, BAR_WIDTH_MM = 3.0, 1.5, 0.2
TICK_EVERY_MM = 10.0
TEXT_MM = 2.4
LINE_MM = 3.4
BAR_X_MM = 8.0  # of the bar along the paper, left of all plates
PATCHES: tuple[tuple[str, Rgb], ...] = (
    ("red", RED_RGB),
    ("green", GREEN_RGB),
    ("white", WHITE_RGB),
    ("black", BLACK_RGB),
)
SMALL = Writing(TEXT_MM, LABEL_RGB)


def draw_sheet(pen: Pen, plan: SheetsPlan, number: int) -> None:
    """One sheet of a plan, counted from 0."""
    for code, place in zip(plan.sheets[number], plan.layout.places(), strict=False):  # the last sheet may hold fewer
        draw_target(pen, plan, code, place)
    _draw_bar_along(pen, plan.layout.paper.height_mm)
    foot_mm = plan.layout.paper.height_mm - EDGE_MM - FOOT_MM
    _draw_bar_across(pen, foot_mm + TICK_MM + 1.0)
    _draw_patches(pen, foot_mm + FOOT_MM - PATCH_MM)
    _draw_words(pen, plan, number, foot_mm + FOOT_MM - PATCH_MM)


def _draw_bar_along(pen: Pen, height_mm: float) -> None:
    top_mm = (height_mm - BAR_MM) / 2
    pen.line((BAR_X_MM, top_mm), (BAR_X_MM, top_mm + BAR_MM), BAR_WIDTH_MM, INK_RGB)
    for at_mm, tick_mm in _ticks():
        pen.line((BAR_X_MM - tick_mm, top_mm + at_mm), (BAR_X_MM, top_mm + at_mm), BAR_WIDTH_MM, INK_RGB)
    words = Writing(TEXT_MM, LABEL_RGB, anchor=0.5, upwards=True)
    pen.text((BAR_X_MM + TEXT_MM, height_mm / 2), f"{BAR_MM:g} mm along the paper", words)


def _draw_bar_across(pen: Pen, y_mm: float) -> None:
    pen.line((SIDE_MM, y_mm), (SIDE_MM + BAR_MM, y_mm), BAR_WIDTH_MM, INK_RGB)
    for at_mm, tick_mm in _ticks():
        pen.line((SIDE_MM + at_mm, y_mm - tick_mm), (SIDE_MM + at_mm, y_mm), BAR_WIDTH_MM, INK_RGB)
    words = f"{BAR_MM:g} mm across the paper; if a bar measures otherwise, print at 100 % or enter what it measures"
    pen.text((SIDE_MM, y_mm + LINE_MM), words, SMALL)


def _ticks() -> list[tuple[float, float]]:
    """Where a bar has ticks, and how long they are; its ends have the long ones."""
    count = round(BAR_MM / TICK_EVERY_MM)
    return [(TICK_EVERY_MM * index, TICK_MM if index in (0, count) else MINOR_TICK_MM) for index in range(count + 1)]


def _draw_patches(pen: Pen, y_mm: float) -> None:
    """The four inks, each in a frame that shows where a pale one ends."""
    for index, (_, rgb) in enumerate(PATCHES):
        x_mm = SIDE_MM + index * PATCH_MM
        pen.rectangle((x_mm, y_mm, PATCH_MM, PATCH_MM), LABEL_RGB)
        inner_mm = PATCH_MM - 2 * BAR_WIDTH_MM
        pen.rectangle((x_mm + BAR_WIDTH_MM, y_mm + BAR_WIDTH_MM, inner_mm, inner_mm), rgb)


def _draw_words(pen: Pen, plan: SheetsPlan, number: int, y_mm: float) -> None:
    layout = plan.layout
    left_mm = SIDE_MM + (len(PATCHES) + 0.5) * PATCH_MM
    first = plan.title or "Scattermark targets"
    second = (
        f"{plan.family.name}, u = {layout.u_mm:g} mm on {layout.paper.name}; sheet {number + 1} of {len(plan.sheets)}"
    )
    for line, text in enumerate((first, f"{second}; {this_software()}")):
        pen.text((left_mm, y_mm + (line + 1) * LINE_MM), text, SMALL)
