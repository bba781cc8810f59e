"""Who wrote a report."""

from __future__ import annotations

from importlib.metadata import version


def this_software() -> str:
    """Name and version, as a report states them."""
    return f"Scattermark {version('scattermark')}"
