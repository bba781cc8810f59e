"""A phone's clock against the server's, from comparisons over a network that delays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from app.errors import InvalidInput


@dataclass(frozen=True)
class ClockComparison:
    """One question for the time.

    Attributes
    ----------
    asked_s, answered_s : float
        By the phone's clock.
    server_s : float
        What the server said, by its own.
    """

    asked_s: float
    answered_s: float
    server_s: float

    @property
    def offset_s(self) -> float:
        """The server's clock less the phone's, if both ways took equally long (RFC 5905, section 8)."""
        return self.server_s - (self.asked_s + self.answered_s) / 2.0

    @property
    def half_delay_s(self) -> float:
        """How far the offset can be wrong: half the round trip."""
        return (self.answered_s - self.asked_s) / 2.0


def choose_comparison(comparisons: Sequence[ClockComparison]) -> ClockComparison:
    """The comparison with the least delay, which bounds the offset most closely (NTP's clock filter).

    Raises
    ------
    InvalidInput
        When there is none, or an answer came before its question.
    """
    if not comparisons:
        raise InvalidInput("no comparison of clocks: ask GET /time a few times")
    if any(comparison.half_delay_s < 0 for comparison in comparisons):
        raise InvalidInput("an answer came before its question: the phone's clock was set meanwhile, compare again")
    return min(comparisons, key=lambda comparison: comparison.half_delay_s)
