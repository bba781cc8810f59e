"""In which unit a figure writes its numbers: metres, but kilometres where metres would be too long to read."""

from __future__ import annotations

from dataclasses import dataclass

KILOMETRES_FROM_M = 10_000.0  # an axis that goes so far is read in km: a system in another frame, say in UTM


@dataclass(frozen=True)
class Unit:
    """A unit and how many of it the base unit of the numbers is."""

    name: str
    per_base: float = 1.0


METRES, KILOMETRES, DEGREES = Unit("m"), Unit("km", 1e-3), Unit("degrees")


def length_unit(greatest_m: float) -> Unit:
    """The unit for lengths up to one in metres."""
    return KILOMETRES if greatest_m >= KILOMETRES_FROM_M else METRES
