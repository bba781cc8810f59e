"""Text of users before it is shown: one line, nothing invisible, nothing that turns the reading direction."""

from __future__ import annotations

UNPRINTABLE = "�"


def readable(text: str) -> str:
    """Runs of white space as one space; control and format characters as a replacement sign."""
    line = " ".join(text.split())
    return "".join(letter if letter.isprintable() else UNPRINTABLE for letter in line)
