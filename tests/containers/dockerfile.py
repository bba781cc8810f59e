"""A Dockerfile as data: stages of instructions, and what of a checkout an engine would be sent."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path


@dataclass(frozen=True)
class Instruction:
    """``RUN ...`` as name and the rest, its lines joined."""

    name: str
    text: str

    @property
    def words(self) -> list[str]:
        """The rest in JSON form, or split."""
        return json.loads(self.text) if self.text.startswith("[") else self.text.split()


@dataclass(frozen=True)
class Stage:
    """From one FROM to the next."""

    base: str
    name: str
    instructions: tuple[Instruction, ...]

    def all(self, name: str) -> list[Instruction]:
        return [instruction for instruction in self.instructions if instruction.name == name]

    def last(self, name: str) -> Instruction:
        return self.all(name)[-1]

    @property
    def environment(self) -> dict[str, str]:
        """What ENV sets, ``$PATH`` and the like as they stand."""
        pairs = (pair for instruction in self.all("ENV") for pair in instruction.words)
        return dict(pair.split("=", 1) for pair in pairs)

    @property
    def health_command(self) -> list[str]:
        """The words of the health check."""
        return json.loads(self.last("HEALTHCHECK").text.split("CMD", 1)[1])


def read_stages(path: Path) -> list[Stage]:
    """The stages of a Dockerfile."""
    lines = [line for line in path.read_text().splitlines() if not line.lstrip().startswith("#")]
    joined = re.sub(r"\\\n\s*", "", "\n".join(lines))
    instructions = [Instruction(*line.split(maxsplit=1)) for line in joined.splitlines() if line.strip()]
    starts = [index for index, instruction in enumerate(instructions) if instruction.name == "FROM"]
    assert starts[0] == 0
    stages = []
    for start, end in zip(starts, [*starts[1:], len(instructions)], strict=True):
        base, *name = instructions[start].words
        stages.append(Stage(base, name[-1] if name else "", tuple(instructions[start + 1 : end])))
    return stages


def sent_to_engine(checkout: Path, relative: Path) -> bool:
    """Whether a file passes ``.dockerignore``: the last pattern that matches it or a folder above it decides."""
    sent = True
    for line in (checkout / ".dockerignore").read_text().splitlines():
        pattern = line.strip()
        if pattern and not pattern.startswith("#"):
            keeps = pattern.startswith("!")
            if _matches(relative, pattern.removeprefix("!")):
                sent = keeps
    return sent


def _matches(relative: Path, pattern: str) -> bool:
    paths = [relative, *list(relative.parents)[:-1]]
    if pattern.startswith("**/"):
        return any(fnmatch(path.name, pattern.removeprefix("**/")) for path in paths)
    return any(len(path.parts) == pattern.count("/") + 1 and fnmatch(str(path), pattern) for path in paths)
