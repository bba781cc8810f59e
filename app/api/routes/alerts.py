"""Alerts: what later snapshots tell of a site's target map."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Body, Depends, Query

from app.api.dependencies import Paging, PathId, ReadSession, Running, Version, WriteSession
from app.api.problems import problems
from app.api.schemas.alerts import AcknowledgeBody, AlertAnswer, AlertsAnswer, SightingsAnswer
from app.api.security import needs
from app.services.alert_sightings import sightings_of
from app.services.alerts import acknowledge
from app.storage.alerts import AlertFilter, AlertKind, AlertRepository, AlertState

router = APIRouter(tags=["alerts"])


def alerts_wanted(
    site_id: PathId,
    state: AlertState | None = None,
    kind: AlertKind | None = None,
    version: Annotated[Version | None, Query(description="Of this version of the map alone.")] = None,
) -> AlertFilter:
    """Which alerts of a site are meant."""
    return AlertFilter(site_id, state, kind, version)


@router.get(
    "/sites/{site_id}/alerts", dependencies=[needs("survey", "analyse")], responses=problems(404, 422, 503, 504)
)
async def list_alerts(
    wanted: Annotated[AlertFilter, Depends(alerts_wanted)], page: Paging, services: Running
) -> AlertsAnswer:
    """Targets that moved, vanished or came new, a map that fits no more: by all snapshots so far, the newest first."""
    return AlertsAnswer.of(await services.map_watch.page(wanted, page))


@router.get("/alerts/{alert_id}", dependencies=[needs("survey", "analyse")], responses=problems(404, 422))
def get_alert(alert_id: PathId, session: ReadSession) -> AlertAnswer:
    """One alert as it was found last."""
    return AlertAnswer.of(AlertRepository(session).get(alert_id))


@router.get("/alerts/{alert_id}/sightings", dependencies=[needs("survey", "analyse")], responses=problems(404, 422))
def list_sightings(alert_id: PathId, session: ReadSession) -> SightingsAnswer:
    """The newest 200 snapshots between an alert's first and last that saw its target."""
    return SightingsAnswer.of(sightings_of(session, alert_id))


@router.post("/alerts/{alert_id}/acknowledge", dependencies=[needs("survey")], responses=problems(400, 404, 413, 422))
def acknowledge_alert(
    alert_id: PathId, session: WriteSession, body: Annotated[AcknowledgeBody | None, Body()] = None
) -> AlertAnswer:
    """Say that an alert is known; it is resolved when snapshots tell so, or when another version is active."""
    return AlertAnswer.of(acknowledge(session, alert_id, (body or AcknowledgeBody()).note))
