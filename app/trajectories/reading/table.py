"""Lines of numbers: each error names its line and its column."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.trajectories.trajectory import Array

COMMENT = "#"
GREATEST_ROWS = 2_000_000  # a month at 1 Hz, 5 h of an IMU-driven system at 100 Hz; some 300 MB while it is read
SHOWN = 40  # characters of a wrong field in the message


class UnreadableTrajectory(InvalidInput):
    """A file that is no trajectory; ``fields`` name the line (from 1) and the column where there is one."""

    slug = "unreadable-trajectory"


@dataclass(frozen=True)
class Table:
    """Numbers with the lines they stood on.

    Attributes
    ----------
    values : ndarray of shape (N, M)
    lines : ndarray of int, shape (N,)
        From 1.
    columns : tuple of str
        Names for messages.
    """

    values: Array
    lines: npt.NDArray[np.int64]
    columns: tuple[str, ...]

    def column(self, name: str) -> Array:
        """The numbers of a column, shape (N,)."""
        return self.values[:, self.columns.index(name)]

    def block(self, names: Sequence[str]) -> Array:
        """The numbers of some columns, shape (N, len(names))."""
        return self.values[:, [self.columns.index(name) for name in names]]

    def has(self, *names: str) -> bool:
        """Whether all of the columns are there."""
        return set(names) <= set(self.columns)

    def refuse(self, row: int, column: str, what: str) -> UnreadableTrajectory:
        """The error that points at one number."""
        line = int(self.lines[row])
        return UnreadableTrajectory(f"line {line}, column {column}: {what}", line=line, column=column)


def text_of(data: bytes) -> str:
    """The text of a file.

    Raises
    ------
    UnreadableTrajectory
        When it is no UTF-8, or empty.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise UnreadableTrajectory(
            f"line {line}: the file is not UTF-8 text; send the trajectory as text", line=line
        ) from error
    if not text.strip():
        raise UnreadableTrajectory("the file is empty; send a trajectory with one pose at least")
    return text


def data_lines(text: str) -> list[tuple[int, str]]:
    """Lines that hold data, with their numbers from 1: no comments, no blank ones.

    Raises
    ------
    UnreadableTrajectory
        When there are more than can be taken.
    """
    numbered = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith(COMMENT)
    ]
    if len(numbered) > GREATEST_ROWS:
        raise UnreadableTrajectory(
            f"line {numbered[GREATEST_ROWS][0]}: the file has more than {GREATEST_ROWS} poses; send it in parts, "
            "or every n-th pose",
            line=numbered[GREATEST_ROWS][0],
            rows=len(numbered),
        )
    return numbered


def read_table(lines: list[tuple[int, str]], columns: tuple[str, ...], separator: str | None = None) -> Table:
    """The numbers of lines that all have the same columns.

    Parameters
    ----------
    lines : list of (int, str)
        As ``data_lines``.
    columns : tuple of str
    separator : str, optional
        White space by default.

    Raises
    ------
    UnreadableTrajectory
        For a wrong count of columns, what is no number, and what is not finite.
    """
    if not lines:
        raise UnreadableTrajectory("the file holds no pose, only comments; send one pose at least")
    for number, line in lines:
        count = len(line.split(separator))
        if count != len(columns):
            raise UnreadableTrajectory(
                f"line {number}: {count} columns, and {len(columns)} are needed: {' '.join(columns)}",
                line=number,
                columns=count,
            )
    values = _numbers(lines, columns, separator)
    table = Table(values, np.array([number for number, _ in lines]), columns)
    wrong = np.argwhere(~np.isfinite(values))
    if len(wrong):
        row, column = (int(index) for index in wrong[0])
        raise table.refuse(row, columns[column], f"{values[row, column]} is no finite number; leave such poses out")
    return table


def _numbers(lines: list[tuple[int, str]], columns: tuple[str, ...], separator: str | None) -> Array:
    try:
        return np.loadtxt([line for _, line in lines], delimiter=separator, comments=None, ndmin=2)
    except ValueError as error:
        for number, line in lines:
            for column, field in zip(columns, line.split(separator), strict=True):
                if not _is_number(field):
                    raise UnreadableTrajectory(
                        f"line {number}, column {column}: {field.strip()[:SHOWN]!r} is no number; correct it",
                        line=number,
                        column=column,
                    ) from error
        raise


def _is_number(field: str) -> bool:
    try:
        np.loadtxt([field], comments=None)
    except ValueError:
        return False
    return bool(field.strip())
