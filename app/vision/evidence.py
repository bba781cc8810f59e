"""Whether what was seen speaks for one word alone.

A family mends by the number of digits. How sure each of them was says more: a word that contradicts a sure digit is
hardly the plate's while another one contradicts doubtful digits only. Of the other words some are those of plates in a
mirror: the base dots lie alike on both sides of their diagonal, so that such a plate looks like one with its rows and
columns exchanged, and only its word tells.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt

from app.targets.digits import Codes, Digits, digits_of_code, digits_of_codes
from app.targets.family import CodeFamily
from app.targets.layout import CELLS_PER_SIDE, DIGIT_CELLS, DOT_COUNT
from app.vision.kernels.inkwell import HIDDEN_DIGIT

Array = npt.NDArray[np.float64]

TYPICAL_CONFIDENCE = 1.0  # more makes no digit surer: white stands farther from its border than the other inks
MIRROR_DISTANCE_MIN = 3  # parity's and full's words are all, or mostly, words in a mirror as well
# Below, each word has a code one digit off, in a mirror, too (Hamming's is a perfect code): only a better fit tells.
MIRROR_NEAR_DISTANCE_MIN = 5


def digits_in_mirror() -> npt.NDArray[np.intp]:
    """The digit that each digit is taken for in a mirror, shape (11,)."""
    cells = list(DIGIT_CELLS)
    exchanged = np.arange(DOT_COUNT).reshape(CELLS_PER_SIDE, CELLS_PER_SIDE).T.ravel()
    return np.array([cells.index(exchanged[cell]) for cell in cells], dtype=np.intp)


DIGITS_IN_MIRROR = digits_in_mirror()


@dataclass(frozen=True)
class SeenWord:
    """What the eleven identification dots of a plate look like.

    Attributes
    ----------
    digits : ndarray of shape (11,)
        The likeliest ones, -1 where a dot shows no ink of the plate.
    confidence : ndarray of shape (11,)
        How sure each is (``InkReading``).
    """

    digits: Digits
    confidence: Array

    def in_mirror(self) -> SeenWord:
        """The word that the plate has if it is seen in a mirror."""
        return SeenWord(self.digits[DIGITS_IN_MIRROR], self.confidence[DIGITS_IN_MIRROR])

    def against(self, words: Digits) -> Array:
        """What speaks against words of shape (N, 11): the confidence of all digits that they contradict, shape (N,)."""
        seen = np.where(self.digits == HIDDEN_DIGIT, 0.0, np.minimum(self.confidence, TYPICAL_CONFIDENCE))
        result: Array = (words != self.digits) @ seen
        return result

    def rival(self, code: int, family: CodeFamily, known_codes: frozenset[int] | None, margin: float) -> str:
        """Why a mended word is not believed: another suits what was seen as well, or nearly; empty when none does.

        Parameters
        ----------
        code : int
            Of the family.
        known_codes : frozenset of int or None
            The codes that the site holds. What a mirror shows of others must suit better to be believed instead.
        margin : float
            By how much more every other word must be contradicted.
        """
        own = float(self.against(digits_of_code(code)[None])[0])
        if own == 0.0:
            return ""
        words = words_of(family)
        if family.distance >= MIRROR_DISTANCE_MIN:
            near_tells = family.distance >= MIRROR_NEAR_DISTANCE_MIN
            known = near_tells if known_codes is None else np.isin(family.codes, list(known_codes))
            if (self.in_mirror().against(words) <= own + np.where(known, margin, -margin)).any():
                return "mirror-image"
        return "unreadable" if (self.against(words[family.codes != code]) <= own + margin).any() else ""


@cache
def words_of(family: CodeFamily) -> Digits:
    """The words of all codes of a family, shape (M, 11)."""
    codes: Codes = family.codes
    return digits_of_codes(codes)
