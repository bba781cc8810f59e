"""Which workers are dead, told by counting: no machine's clock is asked, so none that jumps kills the living."""

from __future__ import annotations

from collections.abc import Iterable

from app.storage.workers import Worker

BEAT_INTERVAL_S = 2.0  # a worker counts up, and looks at the others, this often
# Looks in a row at the same count: 16 s. A worker that is alive beats in each of them; one that is held up for longer
# finds out at its next beat and ends itself. The work is then taken over within 20 s.
LOOKS_BELIEVED = 8


class Lookout:
    """Remembers at what counts it has seen the others, and how often.

    A worker that was stopped (a suspended machine, a debugger) makes no looks meanwhile, so it declares nobody dead
    when it wakes. A look that failed makes all the earlier ones worthless: nobody could beat then either.
    """

    def __init__(self) -> None:
        self._seen: dict[str, tuple[int, int]] = {}  # beats, looks at them

    def look(self, workers: Iterable[Worker]) -> tuple[Worker, ...]:
        """The workers that are dead by now, those that left in order among them."""
        before, self._seen = self._seen, {}
        dead = []
        for worker in workers:
            beats, looks = before.get(worker.worker_id, (worker.beats, 0))
            looks = looks + 1 if beats == worker.beats else 1
            self._seen[worker.worker_id] = worker.beats, looks
            if worker.left or looks > LOOKS_BELIEVED:
                dead.append(worker)
        return tuple(dead)

    def look_failed(self) -> None:
        """Begin to count anew."""
        self._seen.clear()
