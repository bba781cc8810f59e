"""When a snapshot was taken, as its client tells it; times as text, and back."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime

from app.errors import InvalidInput
from app.storage.snapshots import Moment

LATEST_S = 253_402_300_799.0  # the end of the year 9999, the last that ISO 8601 writes with four digits
EXAMPLE = "2026-05-01T09:30:00.250Z or 1777627800.25"


@dataclass(frozen=True)
class ClientClock:
    """What the client says of time.

    Attributes
    ----------
    captured_at : str or None
        Mid-exposure of the middle row by the device's clock: ISO 8601 (UTC when no zone is written) or epoch seconds.
    offset_s : float
        Server UTC = captured_at + offset.
    delay_s : float or None
        Half the round trip with which the offset was found.
    """

    captured_at: str | None = None
    offset_s: float = 0.0
    delay_s: float | None = None


def moment_of(clock: ClientClock, received_s: float) -> Moment:
    """The moment of capture in server time; without a client's word it is the moment of arrival.

    Raises
    ------
    InvalidInput
        For a time that cannot be read.
    """
    if clock.captured_at is None:
        return Moment(received_s, "server")
    captured_s = seconds_of(clock.captured_at, "captured_at") + clock.offset_s
    if not 0.0 <= captured_s <= LATEST_S:
        raise InvalidInput(
            f"captured_at {clock.captured_at!r} with its offset lies before 1970 or after 9999; send {EXAMPLE}",
            field="captured_at",
        )
    return Moment(captured_s, "client", clock.delay_s)


def iso_of(time_s: float) -> str:
    """ISO 8601 in UTC with microseconds."""
    return datetime.fromtimestamp(time_s, UTC).isoformat(timespec="microseconds").replace("+00:00", "Z")


def seconds_of(text: str, field: str) -> float:
    """UTC seconds since 1970 of epoch seconds or ISO 8601 (UTC when no zone is written).

    Raises
    ------
    InvalidInput
        For a text that is no time; ``field`` says which one it was.
    """
    text = text.strip()
    try:
        seconds = float(text)
    except ValueError:
        return _seconds_of_iso(text, field)
    if not math.isfinite(seconds):
        raise _no_time(text, field)
    return seconds


def _seconds_of_iso(text: str, field: str) -> float:
    try:
        # A "+" of a zone that was not escaped in a query arrives as a space.
        moment = datetime.fromisoformat(text.replace(" ", "T" if "T" not in text else "+"))
    except ValueError as error:
        raise _no_time(text, field) from error
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()


def _no_time(text: str, field: str) -> InvalidInput:
    return InvalidInput(f"{field} {text!r} is no time; send {EXAMPLE}", field=field)
