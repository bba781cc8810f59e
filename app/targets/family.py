"""Code families: which of the 3^11 words are printed, and how misread or hidden digits are mended.

All four are linear over GF(3), so one syndrome decoder serves them: it looks up the few changes that explain a word's
syndrome and takes the one that stays within the budget ``2 * errors + erasures <= distance - 1``, inside which no two
codewords compete.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from itertools import combinations, product

import numpy as np
import numpy.typing as npt

from app.errors import InvalidInput
from app.targets.digits import (
    CODE_COUNT,
    DIGIT_BASE,
    DIGIT_COUNT,
    ERASED,
    Codes,
    Digits,
    codes_of_digits,
    digits_of_code,
    digits_of_codes,
)

FAMILY_NAMES = ("golay", "hamming", "parity", "full")
UNDECODABLE = -1

# x^5 + x^4 - x^3 + x^2 - 1, coefficients of descending powers (targets.md, code families).
GOLAY_GENERATOR = (1, 1, -1, 1, 0, -1)
# Columns of H for d0 ... d10, no two proportional: eleven of the thirteen that the full ternary Hamming code has, so
# this shortened one is not perfect and some words lie two dots away from every code.
HAMMING_COLUMNS = ("001", "010", "011", "012", "100", "101", "102", "110", "111", "112", "120")

_DISTANCES = {"golay": 5, "hamming": 3, "parity": 2, "full": 1}

Counts = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Decoded:
    """A word that was read as a code.

    Attributes
    ----------
    code : int
        Printable, so never 0.
    corrected : int
        Digits that were seen and changed.
    erased : int
        Digits that were hidden and filled.
    """

    code: int
    corrected: int
    erased: int


@dataclass(frozen=True)
class CodeFamily:
    """A linear ternary code of length eleven.

    Attributes
    ----------
    name : str
        One of ``FAMILY_NAMES``.
    distance : int
        Least number of digits in which two codes differ.
    parity_check : ndarray of shape (R, 11), int64
        H over GF(3); a word is in the code when ``H @ digits = 0 mod 3``. R = 0 puts every word in the code.
    codes : ndarray of shape (M,), int64
        All printable codes, ascending; 0 (all black) carries no checkable dot and is left out.
    """

    name: str
    distance: int
    parity_check: Counts = field(compare=False, repr=False)
    codes: Codes = field(init=False, compare=False, repr=False)
    _changes: Digits = field(init=False, compare=False, repr=False)  # (S, L, 11): by syndrome, padded

    def __post_init__(self) -> None:
        if self.parity_check.ndim != 2 or self.parity_check.shape[1] != DIGIT_COUNT:
            raise ValueError("a parity check has one column per digit")
        words = digits_of_codes(np.arange(CODE_COUNT))
        codes = np.flatnonzero(self._syndromes(words) == 0)[1:]
        object.__setattr__(self, "codes", codes.astype(np.int64))
        object.__setattr__(self, "_changes", self._changes_by_syndrome())

    def contains(self, code: int) -> bool:
        """Whether the code is printable in this family."""
        return 0 < code < CODE_COUNT and int(self._syndromes(digits_of_code(code))) == 0

    def decode(self, digits: Digits, max_corrections: int) -> Decoded | None:
        """Read one word; None when no printable code lies within the budget.

        Parameters
        ----------
        digits : ndarray of shape (11,)
            0, 1, 2, or -1 where the dot was hidden.
        max_corrections : int
            How many seen digits may be changed, at most; the family's distance limits it further.
        """
        codes, corrected, erased = self.decode_many(np.asarray(digits)[None], max_corrections)
        if codes[0] == UNDECODABLE:
            return None
        return Decoded(int(codes[0]), int(corrected[0]), int(erased[0]))

    def decode_many(self, digits: Digits, max_corrections: int) -> tuple[Codes, Counts, Counts]:
        """Read words of shape (N, 11) as ``decode`` does.

        Returns
        -------
        codes : ndarray of shape (N,), int64
            -1 where nothing printable lies within the budget ``2 * corrected + erased <= distance - 1``.
        corrected, erased : ndarray of shape (N,), int64
            Digits changed and digits filled; for an undecodable word ``corrected`` is 0.
        """
        digits = _checked(digits)
        if max_corrections < 0:
            raise ValueError(f"max_corrections must not be negative, got {max_corrections}")
        hidden = digits == ERASED
        erased = hidden.sum(axis=1)
        words = np.where(hidden, 0, digits)
        codes, corrected = codes_of_digits(words), np.zeros(len(words), dtype=np.int64)
        syndromes = self._syndromes(words)
        # Most words are whole and right: the search is for the others.
        odd = np.flatnonzero((syndromes != 0) | (erased > 0))
        if len(odd):
            codes[odd], corrected[odd] = self._mended(words[odd], hidden[odd], syndromes[odd], max_corrections)
        readable = codes > 0
        return np.where(readable, codes, UNDECODABLE), np.where(readable, corrected, 0), erased

    def _mended(
        self, words: Digits, hidden: npt.NDArray[np.bool_], syndromes: Counts, max_corrections: int
    ) -> tuple[Codes, Counts]:
        """Codes of words of shape (N, 11) and how many seen digits they change; -1 where that is more than allowed."""
        changes = self._changes[syndromes]  # (N, L, 11)
        errors = ((changes != 0) & ~hidden[:, None]).sum(axis=2)
        # Negative: too many are hidden.
        allowed = np.minimum(max_corrections, (self.distance - 1 - hidden.sum(axis=1)) // 2)
        # Within the budget at most one change fits, so the least is the only one.
        best = errors.argmin(axis=1)
        rows = np.arange(len(words))
        corrected = errors[rows, best]
        codes = codes_of_digits((words - changes[rows, best]) % DIGIT_BASE)
        return np.where(corrected <= allowed, codes, UNDECODABLE), corrected

    def _syndromes(self, words: Digits) -> Counts:
        """Syndromes of words of shape (..., 11) as one number each, shape (...); 0 for a codeword."""
        checks = words.astype(np.int64) @ self.parity_check.T % DIGIT_BASE
        place_values = DIGIT_BASE ** np.arange(len(self.parity_check), dtype=np.int64)
        return np.asarray(checks @ place_values)

    def _changes_by_syndrome(self) -> Digits:
        """For each syndrome all words of weight <= distance - 1 that have it, padded by the heaviest word."""
        light = _light_words(self.distance - 1)
        syndromes = self._syndromes(light)
        counts = np.bincount(syndromes, minlength=DIGIT_BASE ** len(self.parity_check))
        # The padding changes every digit: it can never fit a budget below eleven.
        changes = np.ones((len(counts), counts.max(), DIGIT_COUNT), dtype=np.int8)
        order = np.argsort(syndromes, kind="stable")
        ordinal = np.arange(len(light)) - np.repeat(np.cumsum(counts) - counts, counts)
        changes[syndromes[order], ordinal] = light[order]
        return changes


def _checked(digits: Digits) -> Digits:
    digits = np.asarray(digits, dtype=np.int8)
    if digits.ndim != 2 or digits.shape[1] != DIGIT_COUNT:
        raise ValueError(f"words have shape (N, {DIGIT_COUNT}), got {digits.shape}")
    if digits.size and not (digits.min() >= ERASED and digits.max() < DIGIT_BASE):
        raise ValueError("digits are 0, 1, 2, or -1 where the dot was hidden")
    return digits


def _light_words(max_weight: int) -> Digits:
    """All words of at most the given weight, shape (K, 11), the lightest first."""
    words = []
    for weight in range(max_weight + 1):
        for places in combinations(range(DIGIT_COUNT), weight):
            for values in product((1, 2), repeat=weight):
                word = np.zeros(DIGIT_COUNT, dtype=np.int8)
                word[list(places)] = values
                words.append(word)
    return np.stack(words)


def _golay_parity_check() -> Counts:
    """Columns x^10 ... x^0 modulo the generator: a word's syndrome is its remainder."""
    generator = np.array(GOLAY_GENERATOR[1:], dtype=np.int64)
    remainder = np.zeros(len(generator), dtype=np.int64)
    remainder[-1] = 1  # x^0, coefficients of descending powers
    columns = [remainder]
    for _ in range(DIGIT_COUNT - 1):
        shifted = np.append(remainder[1:], 0)
        remainder = (shifted - remainder[0] * generator) % DIGIT_BASE
        columns.append(remainder)
    return np.stack(columns[::-1], axis=1)


def _parity_check(name: str) -> Counts:
    if name == "golay":
        return _golay_parity_check()
    if name == "hamming":
        return np.array([[int(digit) for digit in column] for column in HAMMING_COLUMNS], dtype=np.int64).T
    if name == "parity":
        return np.ones((1, DIGIT_COUNT), dtype=np.int64)
    return np.zeros((0, DIGIT_COUNT), dtype=np.int64)


@cache
def _build_family(name: str) -> CodeFamily:
    return CodeFamily(name, _DISTANCES[name], _parity_check(name))


def family_by_name(name: str) -> CodeFamily:
    """The family of that name, built once per process.

    Raises
    ------
    InvalidInput
        For a name that is none of ``FAMILY_NAMES``.
    """
    if name not in FAMILY_NAMES:
        raise InvalidInput(f"unknown code family {name!r}; use one of {', '.join(FAMILY_NAMES)}", code_family=name)
    return _build_family(name)
