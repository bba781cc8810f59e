"""What it costs to ask who comes: keys that are known, keys that are looked up, rates, and the audit's row.

    python -m benchmarks.access

One thread, SQLite in a temporary folder. Each figure is the time of one call: the median and the 99th of a hundred.
``limits`` is the package (``scattermark[bench]``) whose moving window in memory the rate limiter is compared with,
asked as fast as possible and once in 20 ms: requests that come alone.
"""

from __future__ import annotations

import asyncio
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from limits import RateLimitItemPerSecond
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter

from app.services import key_ring
from app.services.gatekeeper import AccessRules, Credentials, Gatekeeper
from app.services.keys import create_key
from app.services.rates import Rate, RateLimiter
from app.storage.audit import Actor, noting
from app.storage.database import Database
from app.storage.keys import NewKey
from app.storage.migrate import upgrade
from app.storage.sites import SiteRepository
from benchmarks.output import print_table

FAST, SLOW = 2000, 200
PAUSE_S = 0.02
US_PER_S = 1e6
RATE = Rate(1e6, 1000)
HEADINGS = ("one call", "median us", "99 % us")
ADDRESS = "127.0.0.1"


def main() -> None:
    """Measure and print."""
    with _database() as database:
        rows = [*_of_keys(database), *_of_rates(), *_of_audit(database)]
    print_table("What it costs to ask who comes", HEADINGS, rows)


def _of_keys(database: Database) -> Iterator[list[str]]:
    with database.writing() as session:
        secret = create_key(session, NewKey("benchmark", ("locate",))).secret
    gatekeeper = Gatekeeper(database, AccessRules(keys_required=True, trusts_network=False, key_rate=RATE))
    shown = Credentials(secret)
    with asyncio.Runner() as runner:
        runner.run(gatekeeper.admit(shown, ADDRESS))
        yield _row("key that is known, and its rate", runner.run(_times(gatekeeper, shown, FAST)))
        known_s, key_ring.KNOWN_S = key_ring.KNOWN_S, 0.0
        yield _row("key that is looked up, and its rate", runner.run(_times(gatekeeper, shown, SLOW)))
        key_ring.KNOWN_S = known_s


async def _times(gatekeeper: Gatekeeper, shown: Credentials, count: int) -> list[float]:
    """Seconds of each admission."""
    times_s = []
    for _ in range(count):
        began_s = time.perf_counter()
        await gatekeeper.admit(shown, ADDRESS)
        times_s.append(time.perf_counter() - began_s)
    return times_s


def _of_rates() -> Iterator[list[str]]:
    ours, theirs = RateLimiter(), MovingWindowRateLimiter(MemoryStorage())
    window = RateLimitItemPerSecond(1000, 1)
    limiters: dict[str, Callable[[], object]] = {
        "rate": lambda: ours.spend("a", RATE),
        "rate, limits": lambda: theirs.hit(window, "a"),
    }
    for name, spend in limiters.items():
        yield _row(f"{name}, one after the other", _times_of(spend, FAST, 0.0))
        yield _row(f"{name}, once in {PAUSE_S * 1000:.0f} ms", _times_of(spend, SLOW, PAUSE_S))


def _of_audit(database: Database) -> Iterator[list[str]]:
    def change() -> None:
        with database.writing() as session:
            SiteRepository(session).add("hall", "golay", 0.014, None)

    def audited_change() -> None:
        with noting(Actor(None, "benchmark", ADDRESS), "POST /sites", {}):
            change()

    yield _row("change without a row in the audit", _times_of(change, SLOW, 0.0))
    yield _row("change with a row in the audit", _times_of(audited_change, SLOW, 0.0))


def _times_of(call: Callable[[], object], count: int, pause_s: float) -> list[float]:
    times_s = []
    for _ in range(count):
        if pause_s:
            time.sleep(pause_s)
        began_s = time.perf_counter()
        call()
        times_s.append(time.perf_counter() - began_s)
    return times_s


def _row(name: str, times_s: list[float]) -> list[str]:
    worst_s = statistics.quantiles(times_s, n=100)[-1]
    return [name, f"{statistics.median(times_s) * US_PER_S:.1f}", f"{worst_s * US_PER_S:.1f}"]


@contextmanager
def _database() -> Iterator[Database]:
    with tempfile.TemporaryDirectory() as folder:
        database = Database(f"sqlite:///{Path(folder) / 'access.db'}")
        upgrade(database)
        yield database
        database.close()


if __name__ == "__main__":
    main()
