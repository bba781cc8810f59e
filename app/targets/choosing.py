"""Which codes to print: far apart from each other, and with enough lit dots to be told from black; always the same."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from app.errors import InvalidInput
from app.targets.digits import BLACK, DIGIT_BASE, DIGIT_COUNT, Codes, digits_of_codes
from app.targets.family import CodeFamily


@dataclass(frozen=True)
class ChoosingOptions:
    """What makes a code good.

    Attributes
    ----------
    least_lit : int
        White and green dots of a code that is not nearly black: more than half of the eleven. Darker ones are printed
        only when no others are left; each black dot is one that a shadow may have made.
    """

    least_lit: int = DIGIT_COUNT // 2 + 1


def choose_codes(
    family: CodeFamily, count: int, taken: Collection[int] = (), options: ChoosingOptions | None = None
) -> tuple[int, ...]:
    """Codes of a family that differ in as many dots as so many codes can; the same wish gives the same codes.

    Each is the least that keeps the distance from all before it (a lexicode: Conway and Sloane, IEEE Trans. Inf. Theory
    32(3), 1986). Such codes close under addition, so that the distance is kept by more of them than by codes
    picked farthest first: 242 codes of ``golay`` six dots apart rather than some forty.

    Parameters
    ----------
    family : CodeFamily
    count : int
        How many.
    taken : collection of int
        Codes that hang there already: they are not chosen again, and kept away from.
    options : ChoosingOptions, optional

    Returns
    -------
    tuple of int
        Codes that are not nearly black first; within these ascending.

    Raises
    ------
    InvalidInput
        When the family holds fewer codes than are asked for.
    """
    options = options or ChoosingOptions()
    taken_codes = np.array(sorted(taken), dtype=np.int64)
    free = np.setdiff1d(family.codes, taken_codes)
    if not 1 <= count <= len(free):
        raise InvalidInput(
            f"{count} codes of the family {family.name} are asked for, and 1 to {len(free)} can be had; "
            "the families hamming, parity and full hold more",
            field="count",
            code_family=family.name,
            available=len(free),
        )
    lit = (digits_of_codes(free) != BLACK).sum(axis=1)
    bright, dim = free[lit >= options.least_lit], free[lit < options.least_lit]
    for distance in range(DIGIT_COUNT, family.distance, -1):
        if count > DIGIT_BASE ** (DIGIT_COUNT - distance + 1):
            continue  # no code has so many words (Singleton's bound)
        apart = _lexicode(bright, distance, taken_codes)
        if len(apart) >= count:
            return tuple(apart[:count])
    return tuple(np.concatenate([bright, dim])[:count].tolist())


def _lexicode(codes: Codes, distance: int, taken: Codes) -> list[int]:
    """Of codes in ascending order, each that differs in so many dots from the taken ones and from those before it."""
    digits = digits_of_codes(codes)
    for word in digits_of_codes(taken):
        far = (digits != word).sum(axis=1) >= distance
        codes, digits = codes[far], digits[far]
    chosen: list[int] = []
    while len(codes):
        chosen.append(int(codes[0]))
        far = (digits != digits[0]).sum(axis=1) >= distance
        codes, digits = codes[far], digits[far]
    return chosen
