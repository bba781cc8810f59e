"""Figures of several methods in one table, with the one that is ahead, whichever it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from benchmarks.output import print_table


@dataclass(frozen=True)
class Figure:
    """One figure of one method.

    Attributes
    ----------
    label : str
        What it is; the same for all methods.
    text : str
        As it is printed.
    value : float or None
        To be compared; None for what cannot be.
    better : str or None
        Whether less or more of it is better; None for what is not a merit.
    """

    label: str
    text: str
    value: float | None = None
    better: Literal["less", "more"] | None = None


def print_side_by_side(title: str, columns: Mapping[str, Sequence[Figure]]) -> None:
    """A table with a column per method; with several methods also who is ahead in each figure."""
    labels = list(dict.fromkeys(figure.label for figures in columns.values() for figure in figures))
    rows = []
    for label in labels:
        cells = {name: figure for name, figures in columns.items() for figure in figures if figure.label == label}
        texts = [cells[name].text if name in cells else "-" for name in columns]
        rows.append([label, *texts, *([ahead(cells)] if len(columns) > 1 else [])])
    print_table(title, ["what", *columns, *(["ahead"] if len(columns) > 1 else [])], rows)


def ahead(cells: Mapping[str, Figure]) -> str:
    """The method with the better figure; nothing where there is no merit in it or fewer than two have it."""
    merits = {name: figure.value for name, figure in cells.items() if figure.better and figure.value is not None}
    if len(merits) < 2:
        return ""
    if len({cells[name].text for name in merits}) == 1:  # what looks the same is not better
        return "equal"
    less = next(iter(cells.values())).better == "less"
    return min(merits, key=lambda name: merits[name] if less else -merits[name])
