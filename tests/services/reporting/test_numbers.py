from __future__ import annotations

import pytest

from app.services.reporting.numbers import fixed, listed, metres, millimetres, moment, nice_below, signed_percent
from app.services.reporting.text import readable


def test_numbers_have_a_real_minus_and_zero_has_none() -> None:
    assert fixed(-1234.567, 2) == "−1,234.57"  # noqa: RUF001 - a real minus
    assert fixed(-0.0004, 3) == "0.000"
    assert fixed(None, 3) == "–"  # noqa: RUF001 - an en dash
    assert metres(1.23456) == "1.2346"
    assert millimetres(-0.00123456) == "−1.23"  # noqa: RUF001
    assert signed_percent(0.9995) == "−0.050 %"  # noqa: RUF001
    assert signed_percent(1.0012) == "+0.120 %"


def test_times_are_utc() -> None:
    assert moment(0.0) == "1970-01-01 00:00 UTC"


@pytest.mark.parametrize(("count", "text"), [(2, "a0, a1"), (3, "a0, a1, a2"), (5, "a0, a1, a2 and 2 more")])
def test_long_lists_are_counted(count: int, text: str) -> None:
    assert listed([f"a{index}" for index in range(count)], 3) == text


def test_readable_text_is_one_line_of_what_can_be_seen() -> None:
    assert readable(" a\r\n\tb ") == "a b"
    assert readable("a\x00b\u202ec\ufeff") == "a�b�c�"
    assert readable("Łódź 会议室 🙂") == "Łódź 会议室 🙂"


@pytest.mark.parametrize(
    ("value", "nice"), [(1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (0.0499, 0.02), (0.05, 0.05), (7e5, 5e5)]
)
def test_round_numbers(value: float, nice: float) -> None:
    assert nice_below(value) == pytest.approx(nice)
