"""Tables for people, JSON for machines."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

TABLE_WIDTH = 120

console = Console(width=TABLE_WIDTH, highlight=False)


def print_table(title: str, headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """A table in Markdown, so that a README can quote it as it is."""
    table = Table(box=box.MARKDOWN)
    for column, heading in enumerate(headings):
        table.add_column(heading, justify="left" if column == 0 else "right")
    for row in rows:
        table.add_row(*row)
    console.print(f"\n{title}\n")
    console.print(table)


def write_json(path: Path, record: dict[str, Any]) -> None:
    """Write a record, dataclasses and arrays included."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(record, indent=1, default=_plain))
    console.print(f"\nwritten to {path}")


def mm(length_m: float | None) -> str:
    """Millimetres, or a dash for nothing."""
    return "-" if length_m is None else f"{1000.0 * length_m:.2f}"


def _plain(value: Any) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.asdict(value)
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no JSON form")
