"""How often somebody may ask: so many a second in the long run, and so many at once."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

from app.errors import InvalidInput, TooManyRequests

ROUNDING_S = 1e-6  # of sums of monotonic seconds: less than any interval that is asked for
REMEMBERED = 10_000  # askers; beyond it those are forgotten who have not asked for a while


@dataclass(frozen=True)
class Rate:
    """Requests a second in the long run, and how many may come at once after a pause."""

    per_s: float
    burst: int

    def __post_init__(self) -> None:
        if not (math.isfinite(self.per_s) and self.per_s > 0):
            raise InvalidInput(f"a rate is a positive number of requests a second, got {self.per_s}")
        if self.burst < 1:
            raise InvalidInput(f"at least one request may come at once, got {self.burst}")


class RateLimiter:
    """Counts requests by asker, in this process alone; used from one thread.

    Notes
    -----
    The generic cell rate algorithm (ITU-T I.371, virtual scheduling): one number per asker, the time at which all that
    was asked so far would have come at the steady rate. A request may be ahead of it by the burst.
    """

    def __init__(self, clock_s: Callable[[], float] = time.monotonic) -> None:
        self._clock_s = clock_s
        self._due_s: dict[str, float] = {}

    def spend(self, asker: str, rate: Rate) -> None:
        """Count one request.

        Raises
        ------
        TooManyRequests
            When it comes too early; it is not counted then.
        """
        now_s = self._clock_s()
        due_s = max(self._due_s.get(asker, now_s), now_s)
        early_s = due_s - now_s - (rate.burst - 1) / rate.per_s
        if early_s > ROUNDING_S:
            raise TooManyRequests(
                f"more than {rate.per_s:g} requests a second ({rate.burst} at once): come back when Retry-After says, "
                "or ask the operator for a higher rate",
                retry_after_s=math.ceil(early_s),
            )
        if len(self._due_s) >= REMEMBERED:
            self._forget_idle(now_s)
        self._due_s[asker] = due_s + 1 / rate.per_s

    def _forget_idle(self, now_s: float) -> None:
        """Whoever is due has the whole burst again, as if they had never asked."""
        self._due_s = {asker: due_s for asker, due_s in self._due_s.items() if due_s > now_s}
