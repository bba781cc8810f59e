"""What a worker tells Prometheus, on a port of its own: its pool, its steps' durations, its process."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from prometheus_client import start_http_server

from app.errors import InvalidInput
from app.jobs.pool import WorkerPool
from app.services.metrics_of_pools import ConnectionMetrics, PoolMetrics
from app.services.metrics_of_process import process_registry
from app.storage.database import Database


@contextmanager
def metrics_served(port: int, pool: WorkerPool, database: Database) -> Iterator[None]:
    """Answer scrapes for as long as the block lasts; port 0 is none.

    Jobs are not among it: they are in the database, and any server's metrics show them all.

    Raises
    ------
    InvalidInput
        When the port is taken, by another worker of this machine, say.
    """
    if port == 0:
        yield
        return
    registry = process_registry()
    registry.register(PoolMetrics({"build": pool}))
    registry.register(ConnectionMetrics(database))
    try:
        server, thread = start_http_server(port, registry=registry)
    except OSError as error:
        raise InvalidInput(
            f"SCATTERMARK_WORKER_METRICS_PORT={port}: {error.strerror}; give each worker of a machine another"
        ) from error
    try:
        yield
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
