"""The start of every registry: the process itself, its interpreter and the release that it runs."""

from __future__ import annotations

from importlib.metadata import version

from prometheus_client import CollectorRegistry, Gauge, GCCollector, PlatformCollector, ProcessCollector


def process_registry() -> CollectorRegistry:
    """A new registry that holds what is to be known of any process."""
    registry = CollectorRegistry()
    for of_process in (ProcessCollector, PlatformCollector, GCCollector):
        of_process(registry=registry)
    release = Gauge("scattermark_build_info", "The release that runs.", ("version",), registry=registry)
    release.labels(version("scattermark")).set(1)
    return registry
