"""Jobs, workers and photographs, counted in the database when asked for: a scrape of any server shows them all."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator

from prometheus_client.metrics_core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from app.errors import ScattermarkError
from app.services.bounded import Bounded
from app.storage.database import Database
from app.storage.figures import StoredFigures, stored_figures
from app.storage.photo_store import PhotoStore

log = logging.getLogger(__name__)

PATIENCE_S = 3.0  # counting takes milliseconds; Prometheus itself gives up after ten seconds by default


class StoredMetrics(Collector):
    """Figures of the database; without an answer of it, the news that there is none."""

    def __init__(self, database: Database, photos: PhotoStore) -> None:
        self._database = database
        self._photos = photos
        self._figures = Bounded(self._count, PATIENCE_S)

    def collect(self) -> Iterator[Metric]:
        """All figures, or ``scattermark_database_up 0`` alone."""
        try:
            figures, free_bytes = self._figures.ask()
        except (ScattermarkError, TimeoutError) as error:
            log.warning("the database cannot be counted for metrics: %s", error or "no answer")
            yield _gauge("scattermark_database_up", "Whether the database answered this scrape.", 0)
            return
        yield _gauge("scattermark_database_up", "Whether the database answered this scrape.", 1)
        yield from _families(figures)
        yield _gauge("scattermark_disk_free_bytes", "Room on the disk that takes uploads.", free_bytes)

    def _count(self) -> tuple[StoredFigures, int]:
        with self._database.reading() as session:
            return stored_figures(session), self._photos.free_bytes()


def _families(figures: StoredFigures) -> Iterator[Metric]:
    jobs = GaugeMetricFamily("scattermark_jobs", "Jobs by kind and state.", labels=("kind", "state"))
    for (kind, state), number in sorted(figures.jobs.items()):
        jobs.add_metric((kind, state), number)
    yield jobs
    waited_s = 0.0 if figures.oldest_queued_s is None else max(0.0, time.time() - figures.oldest_queued_s)
    yield _gauge("scattermark_jobs_oldest_queued_age_seconds", "Age of the job that waits longest.", waited_s)
    yield _gauge("scattermark_workers_alive", "Workers whose heartbeat is fresh, wherever.", figures.live_workers)
    alerts = GaugeMetricFamily(
        "scattermark_map_alerts", "Alerts of target maps that are not over.", labels=("kind", "severity")
    )
    for (kind, severity), number in sorted(figures.standing_alerts.items()):
        alerts.add_metric((kind, severity), number)
    yield alerts
    yield _gauge("scattermark_photographs", "Photographs of surveys, equal ones counted once.", figures.photographs)
    yield _gauge("scattermark_kept_snapshots", "Snapshots whose picture was kept.", figures.kept_snapshots)
    yield _gauge("scattermark_stored_bytes", "What all these pictures take.", figures.stored_bytes)


def _gauge(name: str, text: str, value: float) -> GaugeMetricFamily:
    return GaugeMetricFamily(name, text, value=value)
