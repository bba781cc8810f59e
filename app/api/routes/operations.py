"""For operators and clocks."""

from __future__ import annotations

import time

from fastapi import APIRouter, Request, Response
from fastapi.responses import PlainTextResponse
from pydantic import BaseModel, Field

from app.api.dependencies import Running
from app.api.metrics_page import MetricsPage
from app.api.problems import problems
from app.api.security import needs

router = APIRouter(tags=["operations"])


class TimeAnswer(BaseModel):
    """The server's clock."""

    server_time_s: float


class HealthAnswer(BaseModel):
    """A process that answers."""

    status: str


class ReadyAnswer(HealthAnswer):
    """What requests depend on."""

    status: str = Field(description="ready, degraded (snapshots are located, something else waits) or not ready.")
    checks: dict[str, str] = Field(description="Each check by name: ok, or what is wrong and what to do.")


@router.get("/time")
async def get_time() -> TimeAnswer:
    """UTC in seconds since 1970, for a client's clock offset."""
    return TimeAnswer(server_time_s=time.time())


@router.get("/healthz")
async def get_health() -> HealthAnswer:
    """Whether the process answers at all."""
    return HealthAnswer(status="ok")


@router.get("/readyz", responses={503: {"model": ReadyAnswer, "description": "Not ready"}})
async def get_readiness(request: Request, response: Response, services: Running) -> ReadyAnswer:
    """Whether the server can do its work now, check by check; the answer comes within seconds, whatever hangs."""
    report = await services.readiness.look(request.app.state.draining.announced)
    response.status_code = 200 if report.takes_requests else 503
    return ReadyAnswer(status=report.status, checks=dict(report.checks))


@router.get(
    "/metrics",
    response_class=PlainTextResponse,
    responses=problems(504),
    dependencies=[needs("admin", "analyse")],
)
async def get_metrics(request: Request) -> Response:
    """What Prometheus reads."""
    page: MetricsPage = request.app.state.metrics_page
    return await page.answer()
