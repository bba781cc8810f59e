"""How systems look in figures: told apart by colour, and without colours by dashes."""

from __future__ import annotations

from typing import get_args

from app.services.reporting.drawing import Pen, Series

WIDTH = 500.0  # of a sheet, points: what an A4 page holds beside its margins
FRAME = Pen("muted", 0.6)
STROKE = 1.3
COLOURS: tuple[Series, ...] = get_args(Series)
DASHES: tuple[tuple[float, ...], ...] = ((), (5.0, 2.0), (1.2, 1.8), (7.0, 2.0, 1.2, 2.0), (3.0, 1.5), (9.0, 3.0))
LONGEST_NAME = 32
CHI2_95_2D = 5.991  # 95 % of a chi-squared distribution of two degrees of freedom
CHI2_95_3D = 7.815  # of three
SIGMAS_95 = 1.96  # 95 % of a normal distribution lie within, on both sides


def pens(names: list[str]) -> dict[str, Pen]:
    """A stroke for each system: neighbours differ in colour and in dashes, so that grey print tells them apart."""
    count = len(COLOURS)
    return {
        name: Pen(COLOURS[index % count], STROKE, dash=DASHES[(index + index // count) % len(DASHES)])
        for index, name in enumerate(names)
    }


def short(name: str) -> str:
    """A name for a figure."""
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"
