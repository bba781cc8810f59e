"""What it costs to be watched: ``python -m benchmarks.operations``.

A request that does nothing goes through the service's own layers in this process, without a network, so that a few
microseconds can be seen. Layers are put on one after the other; each line is the median over rounds, and rounds of all
lines alternate, as a machine's pace drifts.
"""

from __future__ import annotations

import asyncio
import io
import statistics
import time
from collections.abc import Callable, Sequence

from prometheus_client import CollectorRegistry
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.faults import FaultsAsProblems
from app.api.http_metrics import HttpMetrics
from app.api.observed import Observed
from app.api.request_id import RequestIds
from app.api.streams import StreamsEndWithServer
from app.logs import LogOptions, configure_logs
from app.services.draining import Draining

REQUESTS = 1000
ROUNDS = 15
US_PER_S = 1e6
HEADERS = [(b"host", b"127.0.0.1"), (b"content-type", b"image/jpeg")]


class Route:
    """As much of a route as is looked at."""

    path_format = "/trajectories/{trajectory_id}"


async def nothing(scope: Scope, _receive: Receive, send: Send) -> None:
    """An application that answers at once."""
    scope["route"] = Route
    scope["path_params"] = {"trajectory_id": "01a2043c-dca5-71c7-ab59-262c5732a7b3"}
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"{}"})


def observed(app: ASGIApp) -> ASGIApp:
    """Counted and timed; logged when the level asks for it."""
    return Observed(app, HttpMetrics(CollectorRegistry()))


# From the inside to the outside, as app/api/app.py has them.
LAYERS: Sequence[tuple[str, Callable[[ASGIApp], ASGIApp]]] = (
    ("faults as problems", FaultsAsProblems),
    ("streams end with the server", lambda app: StreamsEndWithServer(app, Draining())),
    ("counted and timed", observed),
    ("request id", RequestIds),
)


async def receive() -> Message:
    """An empty body."""
    return {"type": "http.request", "body": b"", "more_body": False}


async def send(_message: Message) -> None:
    """Nobody reads the answer."""


async def one_round_us(app: ASGIApp) -> float:
    """Microseconds of one request."""
    scope = {"type": "http", "method": "GET", "path": "/", "query_string": b"", "state": {}}
    began_s = time.perf_counter()
    for _ in range(REQUESTS):
        await app({**scope, "headers": list(HEADERS)}, receive, send)
    return US_PER_S * (time.perf_counter() - began_s) / REQUESTS


def stacks() -> dict[str, tuple[str, ASGIApp]]:
    """The level of the log and the application, by what is measured."""
    app: ASGIApp = nothing
    found = {"nothing": ("warning", app)}
    for name, layer in LAYERS:
        app = layer(app)
        found[f"+ {name}"] = ("warning", app)
    return {**found, "+ a line of the log": ("info", app)}


def main() -> None:
    """Measure and print a table."""
    measured = stacks()
    rounds: dict[str, list[float]] = {name: [] for name in measured}
    for _ in range(ROUNDS):
        for name, (level, app) in measured.items():
            configure_logs(LogOptions("json", level), io.StringIO())
            rounds[name].append(asyncio.run(one_round_us(app)))
    print(f"{'':32}{'us/request':>12}{'of it':>10}")
    before_us = 0.0
    for name, values in rounds.items():
        median_us = statistics.median(values)
        print(f"{name:32}{median_us:12.1f}{median_us - before_us:10.1f}")
        before_us = median_us


if __name__ == "__main__":
    main()
