"""Numbers as this report writes them: errors to 0.1 mm, whatever the system."""

from __future__ import annotations

from app.services.reporting.numbers import MISSING, fixed
from app.trajectories.metrics.bootstrap import Interval

ERROR_DIGITS = 4
PERCENT = 100.0


def error_m(value_m: float | None) -> str:
    """An error in metres."""
    return fixed(value_m, ERROR_DIGITS)


def interval_m(interval: Interval | None) -> str:
    """A statistic in metres and the interval around it."""
    if interval is None:
        return MISSING
    return f"{error_m(interval.value)} ({error_m(interval.low)} to {error_m(interval.high)})"


def percent(share: float | None) -> str:
    """A share in percent, without the sign."""
    return fixed(None if share is None else PERCENT * share, 1)
