"""Values of a plan file with the line they stand in, so that whoever wrote it is told where it is wrong.

A plan is YAML 1.1 or JSON; both are read to the same tree of nodes. Nothing in it is executed.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import yaml

from app.errors import InvalidInput

Array = npt.NDArray[np.float64]

MOST_BYTES = 4_000_000  # of a plan: thousands of targets, listed one by one, are a tenth of it
STRING, BOOLEAN, NULL = (f"tag:yaml.org,2002:{kind}" for kind in ("str", "bool", "null"))


@dataclass(frozen=True)
class Field:
    """A value of a plan: where it stands and what it is.

    Attributes
    ----------
    node : yaml.Node
    path : str
        As ``walls[2].height_m``; empty for the whole plan.
    source : str
        The file's name.
    """

    node: yaml.Node
    path: str
    source: str

    def error(self, problem: str) -> InvalidInput:
        """What is wrong here, to be raised."""
        line = self.node.start_mark.line + 1
        return InvalidInput(
            f"{self.source}, line {line}, {self.path or 'the plan'}: {problem}",
            file=self.source,
            line=line,
            field=self.path,
        )

    def members(self, *known: str) -> dict[str, Field]:
        """The members of an object, of which all are known.

        Raises
        ------
        InvalidInput
            When it is no object, or names a member twice or one that nobody knows.
        """
        if not isinstance(self.node, yaml.MappingNode):
            raise self.error(f"an object with {', '.join(known)} is needed")
        found: dict[str, Field] = {}
        for key, value in self.node.value:
            name = str(key.value)
            member = Field(value, f"{self.path}.{name}" if self.path else name, self.source)
            if name in found:
                raise member.error("it is said twice")
            if name not in known:
                near = difflib.get_close_matches(name, known, 1)
                meant = f"; is {near[0]} meant?" if near else f"; known are {', '.join(known)}"
                raise Field(key, member.path, self.source).error(f"there is no such field{meant}")
            if value.tag != NULL:
                found[name] = member
        return found

    def needed(self, members: dict[str, Field], name: str) -> Field:
        """A member of this object that must be there."""
        if name not in members:
            raise self.error(f"{name} is missing")
        return members[name]

    def items(self) -> list[Field]:
        """The items of a list."""
        if not isinstance(self.node, yaml.SequenceNode):
            raise self.error("a list is needed")
        return [Field(node, f"{self.path}[{index}]", self.source) for index, node in enumerate(self.node.value)]

    def text(self) -> str:
        """A line of text; numbers are taken as they are written."""
        if not isinstance(self.node, yaml.ScalarNode) or not self.node.value.strip():
            raise self.error("text is needed")
        return str(self.node.value)

    def one_of(self, choices: Sequence[str]) -> str:
        """One of some words."""
        text = self.text()
        if text not in choices:
            raise self.error(f"{text!r} is none of {', '.join(choices)}")
        return text

    def flag(self) -> bool:
        """True or false."""
        if self.node.tag != BOOLEAN:
            raise self.error("true or false is needed")
        return str(self.node.value).lower() in ("true", "yes", "on")

    def number(self, least: float = -np.inf, greatest: float = np.inf) -> float:
        """A finite number between two others, both included."""
        try:
            if not isinstance(self.node, yaml.ScalarNode) or self.node.tag == BOOLEAN:
                raise ValueError
            number = float(self.node.value)  # YAML 1.1 takes 1e-3 for text
        except ValueError:
            raise self.error("a number is needed") from None
        if not np.isfinite(number):
            raise self.error("a finite number is needed")
        if not least <= number <= greatest:
            raise self.error(f"{number:g} is not {_range(least, greatest)}")
        return number

    def positive(self, greatest: float = np.inf) -> float:
        """A number above zero."""
        return self.number(float(np.finfo(np.float64).tiny), greatest)

    def integer(self, least: int, greatest: int) -> int:
        """A whole number between two others, both included."""
        number = self.number(least, greatest)
        if number != int(number):
            raise self.error(f"{number:g} is no whole number")
        return int(number)

    def vector(self, *lengths: int) -> Array:
        """A list of so many finite numbers, in one of some lengths."""
        numbers = [item.number() for item in self.items()]
        if len(numbers) not in lengths:
            raise self.error(f"{' or '.join(map(str, lengths))} numbers are needed, there are {len(numbers)}")
        return np.array(numbers)


def read_fields(path: Path) -> Field:
    """The tree of a plan file.

    Raises
    ------
    InvalidInput
        When it is missing, too large, or neither YAML nor JSON.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InvalidInput(f"cannot read the plan {path}: {error.strerror}") from error
    return fields_of_text(content, path.name)


def fields_of_text(content: bytes, source: str) -> Field:
    """The tree of a plan's text; ``source`` is what errors call it.

    Raises
    ------
    InvalidInput
        When it is too large, or neither YAML nor JSON.
    """
    if len(content) > MOST_BYTES:
        raise InvalidInput(f"{source} has {len(content)} bytes; a plan has at most {MOST_BYTES}")
    try:
        text = content.decode("utf-8-sig")
        if text.lstrip().startswith("{"):
            text = text.replace("\t", " ")  # JSON may be indented with tabs, YAML may not
        node = yaml.compose(text, Loader=yaml.SafeLoader)
    except UnicodeDecodeError as error:
        raise InvalidInput(f"{source} is no UTF-8 text (byte {error.start}); save it as UTF-8") from error
    except yaml.MarkedYAMLError as error:
        line = 0 if error.problem_mark is None else error.problem_mark.line + 1
        raise InvalidInput(
            f"{source}, line {line}: neither YAML nor JSON ({error.problem})", file=source, line=line
        ) from error
    except (yaml.YAMLError, RecursionError) as error:
        raise InvalidInput(f"{source} is neither YAML nor JSON: {error}") from error
    if node is None:
        raise InvalidInput(f"{source} is empty; a plan names at least walls or targets")
    return Field(node, "", source)


def _range(least: float, greatest: float) -> str:
    if np.isinf(greatest):
        return "positive" if least > 0 else f"{least:g} or more"
    return f"between {max(least, 0.0) if least < 1e-300 and least > 0 else least:g} and {greatest:g}"
