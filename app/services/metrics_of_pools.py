"""Worker pools and database connections, read when they are asked for; the pools' work, as it is done."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from prometheus_client import Histogram
from prometheus_client.metrics_core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from app.services.ports import CpuPool, PoolFigures
from app.storage.database import Database

# Name, what it says, and the figure.
GAUGES = (
    ("scattermark_pool_workers", "Living worker processes.", "workers"),
    ("scattermark_pool_workers_busy", "Worker processes at work.", "busy"),
    ("scattermark_pool_tasks_waiting", "Pieces of work that wait for a worker.", "waiting"),
)
COUNTERS = (
    ("scattermark_pool_refused_tasks", "Pieces of work that were not let in, as the queue was full.", "refused"),
    ("scattermark_pool_crashed_tasks", "Pieces of work that a worker process died of.", "crashed"),
    ("scattermark_pool_timed_out_tasks", "Pieces of work that outlasted their time limit.", "timed_out"),
    ("scattermark_pool_worker_starts", "Worker processes that were started, replacements included.", "started"),
)
POOL_LABEL = ("pool",)
TASK_LABELS = ("pool", "task")
# A snapshot takes tens of milliseconds, an adjustment of hundreds of photographs minutes.
TASK_BUCKETS_S = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 60.0, 600.0)


class PoolMetrics(Collector):
    """Figures of pools by name, and the time of each piece of their work; a task is named by its function."""

    def __init__(self, pools: Mapping[str, CpuPool]) -> None:
        self._pools = pools
        self._waits = Histogram(
            "scattermark_pool_task_wait_seconds",
            "Time that a piece of work waited for a worker process.",
            TASK_LABELS,
            buckets=TASK_BUCKETS_S,
            registry=None,
        )
        self._runs = Histogram(
            "scattermark_pool_task_duration_seconds",
            "Time that a worker process took for a piece of work.",
            TASK_LABELS,
            buckets=TASK_BUCKETS_S,
            registry=None,
        )
        for name, pool in pools.items():
            pool.on_done = partial(self._done, name)

    def _done(self, pool: str, task: str, waited_s: float, running_s: float) -> None:
        self._waits.labels(pool, task).observe(waited_s)
        self._runs.labels(pool, task).observe(running_s)

    def collect(self) -> Iterator[Metric]:
        """One family per figure, one sample per pool, then the times."""
        figures = {name: pool.figures for name, pool in self._pools.items()}
        for kind, families in ((GaugeMetricFamily, GAUGES), (CounterMetricFamily, COUNTERS)):
            for name, text, figure in families:
                yield _with_samples(kind(name, text, labels=POOL_LABEL), figures, figure)
        yield from self._waits.collect()
        yield from self._runs.collect()


class ConnectionMetrics(Collector):
    """How many connections to the database are open and in use; each access has its own."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def collect(self) -> Iterator[Metric]:
        """One sample per access and state."""
        family = GaugeMetricFamily(
            "scattermark_database_connections", "Open connections to the database.", labels=("access", "state")
        )
        for access, (in_use, idle) in self._database.connections().items():
            family.add_metric((access, "in_use"), in_use)
            family.add_metric((access, "idle"), idle)
        yield family


def _with_samples(
    family: GaugeMetricFamily | CounterMetricFamily, figures: Mapping[str, PoolFigures], figure: str
) -> Metric:
    for pool, of_pool in figures.items():
        family.add_metric((pool,), getattr(of_pool, figure))
    return family
