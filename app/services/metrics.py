"""What the service counts of its own work: snapshots and their stages as they happen, all else when it is asked for.

Nothing is global: an application holds its metrics in a registry of its own. Names and units follow Prometheus's
conventions; labels take few values, which the code names, never ids.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from prometheus_client import CollectorRegistry, Counter, Histogram
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector

from app.errors import NotLocated, ScattermarkError

MS_PER_S = 1000.0
# Stages take from tenths of a millisecond (reading a small header) to seconds (a photograph of 60 megapixels).
STAGE_BUCKETS_S = (0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0)
RECORD, TOTAL = "record", "total"


class ServiceMetrics(Collector):
    """Counts of one running service, and whatever else is to be collected with them."""

    def __init__(self) -> None:
        self._registry = CollectorRegistry()
        self._located = Counter(
            "scattermark_locate_located_total", "Snapshots that got a pose.", registry=self._registry
        )
        self._refused = Counter(
            "scattermark_locate_refusals_total",
            "Snapshots without a pose, by reason of the refusal or by kind of the problem.",
            ("reason",),
            registry=self._registry,
        )
        self._stages = Histogram(
            "scattermark_locate_stage_duration_seconds",
            "Time that a snapshot spent in each stage of its work, and being recorded.",
            ("stage",),
            buckets=STAGE_BUCKETS_S,
            registry=self._registry,
        )

    def include(self, collector: Collector) -> None:
        """Collect this as well."""
        self._registry.register(collector)

    def collect(self) -> Iterable[Metric]:
        """All of it, for a scrape."""
        return self._registry.collect()

    @contextmanager
    def answering(self) -> Iterator[None]:
        """Count what becomes of one snapshot within the block."""
        try:
            yield
        except NotLocated as refusal:
            self._refused.labels(str(refusal.fields.get("reason", refusal.slug))).inc()
            raise
        except ScattermarkError as problem:
            self._refused.labels(problem.slug).inc()
            raise
        self._located.inc()

    @contextmanager
    def recording(self, timing_ms: Iterable[tuple[str, float]]) -> Iterator[None]:
        """Count the stages of one snapshot's work, and as another the block that records it.

        Parameters
        ----------
        timing_ms : iterable of (str, float)
            Stages by name, in milliseconds; their total is left out.
        """
        for stage, duration_ms in timing_ms:
            if stage != TOTAL:
                self._stages.labels(stage).observe(duration_ms / MS_PER_S)
        with self._stages.labels(RECORD).time():
            yield
