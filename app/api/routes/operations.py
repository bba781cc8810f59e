"""For operators and clocks."""

from __future__ import annotations

import time

from fastapi import APIRouter, Response
from pydantic import BaseModel

from app.api.dependencies import Running
from app.services.readiness import OK

router = APIRouter(tags=["operations"])


class TimeAnswer(BaseModel):
    """The server's clock."""

    server_time_s: float


class HealthAnswer(BaseModel):
    """A process that answers."""

    status: str


class ReadyAnswer(HealthAnswer):
    """What requests depend on."""

    checks: dict[str, str]


@router.get("/time")
async def get_time() -> TimeAnswer:
    """UTC in seconds since 1970, for a client's clock offset."""
    return TimeAnswer(server_time_s=time.time())


@router.get("/healthz")
async def get_health() -> HealthAnswer:
    """Whether the process answers at all."""
    return HealthAnswer(status="ok")


@router.get("/readyz", responses={503: {"model": ReadyAnswer, "description": "Not ready"}})
def get_readiness(response: Response, services: Running) -> ReadyAnswer:
    """Whether the server can do its work now, check by check."""
    checks = services.readiness.checks()
    ready = all(outcome == OK for outcome in checks.values())
    response.status_code = 200 if ready else 503
    return ReadyAnswer(status="ready" if ready else "not ready", checks=checks)
