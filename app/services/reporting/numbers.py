"""Numbers as reports write them: units chosen once, digits as many as are worth reading, a real minus."""

from __future__ import annotations

from datetime import UTC, datetime

MM_PER_M = 1000.0
MDEG_PER_DEG = 1000.0
MISSING = "–"  # noqa: RUF001 - an en dash is meant
MINUS = "−"  # noqa: RUF001 - a minus is meant
NICE_STEPS = (1.0, 2.0, 5.0, 10.0)


def fixed(value: float | None, digits: int) -> str:
    """A number with so many decimals; a dash for none."""
    if value is None:
        return MISSING
    text = f"{value:,.{digits}f}"
    if float(text.replace(",", "")) == 0.0:  # no minus before a rounded zero
        text = text.removeprefix("-")
    return text.replace("-", MINUS)


def metres(value_m: float) -> str:
    """A coordinate, to 0.1 mm."""
    return fixed(value_m, 4)


def millimetres(value_m: float | None) -> str:
    """A length in mm, to 0.01 mm."""
    return fixed(None if value_m is None else MM_PER_M * value_m, 2)


def pixels(value_px: float) -> str:
    """A residual in px."""
    return fixed(value_px, 3)


def count(value: int) -> str:
    """A count."""
    return f"{value:,d}"


def signed_percent(ratio: float) -> str:
    """How far a ratio is from 1, in percent."""
    text = f"{100.0 * (ratio - 1.0):+.3f}"
    return f"{text.replace('-', MINUS)} %"


def moment(time_s: float) -> str:
    """A time, UTC."""
    return datetime.fromtimestamp(time_s, UTC).strftime("%Y-%m-%d %H:%M UTC")


def listed(items: list[str] | tuple[str, ...], most: int) -> str:
    """Items in a row; what is beyond ``most`` is only counted."""
    shown = ", ".join(items[:most])
    return shown if len(items) <= most else f"{shown} and {len(items) - most} more"


def nice_below(value: float) -> float:
    """The greatest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** float(f"{value:e}".split("e")[1])
    return max(step * power for step in NICE_STEPS if step * power <= value * (1.0 + 1e-9))
