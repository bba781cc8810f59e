"""Lines of numbers: each error names its line and its column."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.trajectories.trajectory import Array

COMMENT = "#"
GREATEST_ROWS = 2_000_000  # a month at 1 Hz, 5 h of an IMU-driven system at 100 Hz; some 300 MB while it is read
GREATEST_LINES = 2 * GREATEST_ROWS  # comments, blank lines and other sensors' records among them
PIECE = 1 << 20  # characters of a text that are split at a time
GREATEST_NUMBER = 1e20  # nanoseconds since 1970 are 2e18, the rest is metres
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
        When it is no UTF-8, empty, or has more lines than poses and comments ever need: seen before it is decoded.
    """
    if data.count(b"\n") > GREATEST_LINES:
        raise UnreadableTrajectory(
            f"the file has more than {GREATEST_LINES} lines, and {GREATEST_ROWS} poses can be taken; send it in parts, "
            "or every n-th pose"
        )
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise UnreadableTrajectory(
            f"line {line}: the file is not UTF-8 text; send the trajectory as text", line=line
        ) from error
    if not text or text.isspace():
        raise UnreadableTrajectory("the file is empty; send a trajectory with one pose at least")
    return text


def data_lines(text: str) -> list[tuple[int, str]]:
    """Lines that hold data, with their numbers from 1: no comments, no blank ones.

    Raises
    ------
    UnreadableTrajectory
        When there are more than can be taken.
    """
    numbered: list[tuple[int, str]] = []
    for number, line in enumerate(_lines(text), start=1):
        if line.strip() and not line.lstrip().startswith(COMMENT):
            if len(numbered) == GREATEST_ROWS:
                raise UnreadableTrajectory(
                    f"line {number}: the file has more than {GREATEST_ROWS} poses; send it in parts, or every n-th "
                    "pose",
                    line=number,
                )
            numbered.append((number, line))
    return numbered


def _lines(text: str) -> Iterator[str]:
    """The lines of a text, split some at a time: of a file with too many they never all stand in memory."""
    start = 0
    while start < len(text):
        cut = text.rfind("\n", start, start + PIECE)
        end = len(text) if cut < 0 else cut + 1
        yield from text[start:end].splitlines()
        start = end


def read_table(
    lines: list[tuple[int, str]],
    columns: tuple[str, ...],
    separator: str | None = None,
    skipped: frozenset[str] = frozenset(),
) -> Table:
    """The numbers of lines that all have the same columns.

    Parameters
    ----------
    lines : list of (int, str)
        As ``data_lines``.
    columns : tuple of str
    separator : str, optional
        White space by default.
    skipped : frozenset of str
        Columns that are counted but not read.

    Raises
    ------
    UnreadableTrajectory
        For a wrong count of columns, what is no number, and what is not finite or beyond all use.
    """
    if not lines:
        raise UnreadableTrajectory("the file holds no pose; send one pose at least")
    _check_counts(lines, columns, separator)
    places = tuple(place for place, column in enumerate(columns) if column not in skipped)
    kept = tuple(columns[place] for place in places)
    values = _numbers(lines, dict(zip(places, kept, strict=True)), separator)
    table = Table(values, np.array([number for number, _ in lines]), kept)
    wrong = np.argwhere(~(np.abs(values) < GREATEST_NUMBER))
    if len(wrong):
        row, column = (int(index) for index in wrong[0])
        raise table.refuse(row, kept[column], f"{values[row, column]} is no finite number of use; leave such poses out")
    return table


def _check_counts(lines: list[tuple[int, str]], columns: tuple[str, ...], separator: str | None) -> None:
    for number, line in lines:
        count = len(line.split(separator))
        if count != len(columns):
            raise UnreadableTrajectory(
                f"line {number}: {count} columns, and {len(columns)} are needed: {' '.join(columns)}",
                line=number,
                columns=count,
            )


def _numbers(lines: list[tuple[int, str]], columns: dict[int, str], separator: str | None) -> Array:
    """The columns at the places that ``columns`` names, shape (N, M)."""
    texts = [line for _, line in lines]
    try:
        return np.loadtxt(texts, delimiter=separator, comments=None, ndmin=2, usecols=tuple(columns))
    except ValueError as error:
        for number, line in lines:
            fields = line.split(separator)
            for place, column in columns.items():
                if not _is_number(fields[place]):
                    raise UnreadableTrajectory(
                        f"line {number}, column {column}: {fields[place].strip()[:SHOWN]!r} is no number; correct it",
                        line=number,
                        column=column,
                    ) from error
        raise


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return "_" not in field  # 1_000 is a number to Python alone
