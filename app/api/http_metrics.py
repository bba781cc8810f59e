"""What is counted of requests: how many, how long, how many at a time. Labels are names of the code, not of data."""

from __future__ import annotations

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram

METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
OTHER = "other"
# From a read that takes a millisecond to a survey's upload of many photographs.
DURATION_BUCKETS_S = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0)


class HttpMetrics:
    """Counts of one application, in its registry.

    Parameters
    ----------
    registry : CollectorRegistry
        The application's own: several applications may live in one process.
    """

    def __init__(self, registry: CollectorRegistry) -> None:
        self.registry = registry
        self.in_flight = Gauge(
            "scattermark_http_requests_in_flight", "Requests that are being answered.", registry=registry
        )
        self.sockets = Gauge("scattermark_http_websockets_open", "WebSockets that are open.", registry=registry)
        self._requests = Counter(
            "scattermark_http_requests_total",
            "Requests that were answered; status 499: the client left before.",
            ("method", "route", "status"),
            registry=registry,
        )
        self._durations = Histogram(
            "scattermark_http_request_duration_seconds",
            "Time from a request's head to the end of its answer; of a stream of events, to its beginning.",
            ("method", "route"),
            buckets=DURATION_BUCKETS_S,
            registry=registry,
        )

    def answered(self, method: str, route: str, status: int, duration_s: float) -> None:
        """Count one request."""
        method = method if method in METHODS else OTHER
        self._requests.labels(method, route, str(status)).inc()
        self._durations.labels(method, route).observe(duration_s)
