"""A code and its eleven ternary digits: white is 2, green is 1, black is 0; d0 is the most significant."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Digits = npt.NDArray[np.int8]  # (..., 11), values 0, 1, 2, or ERASED
Codes = npt.NDArray[np.int64]

BLACK, GREEN, WHITE = 0, 1, 2
ERASED = -1  # a digit that was hidden; it is not black

DIGIT_BASE = 3
DIGIT_COUNT = 11
CODE_COUNT = DIGIT_BASE**DIGIT_COUNT  # 177,147
PLACE_VALUES: Codes = DIGIT_BASE ** np.arange(DIGIT_COUNT - 1, -1, -1, dtype=np.int64)


def digits_of_codes(codes: Codes) -> Digits:
    """Digits, shape (..., 11), of codes of shape (...)."""
    codes = np.asarray(codes, dtype=np.int64)
    if codes.size and not (codes.min() >= 0 and codes.max() < CODE_COUNT):
        raise ValueError(f"a code lies within 0 ... {CODE_COUNT - 1}")
    return (codes[..., None] // PLACE_VALUES % DIGIT_BASE).astype(np.int8)


def codes_of_digits(digits: Digits) -> Codes:
    """Codes, shape (...), of digits of shape (..., 11), none of them erased."""
    digits = np.asarray(digits)
    if digits.shape[-1] != DIGIT_COUNT:
        raise ValueError(f"a code has {DIGIT_COUNT} digits, got {digits.shape[-1]}")
    if digits.size and not (digits.min() >= BLACK and digits.max() <= WHITE):
        raise ValueError("digits are 0 (black), 1 (green) or 2 (white); fill the erased ones first")
    return digits.astype(np.int64) @ PLACE_VALUES


def digits_of_code(code: int) -> Digits:
    """The eleven digits, shape (11,), of one code."""
    return digits_of_codes(np.array(code))


def code_of_digits(digits: Digits) -> int:
    """The code of eleven digits, none of them erased."""
    return int(codes_of_digits(digits))
