"""Alerts of a site's target map."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, Field

from app.api.schemas.common import Body, Listing, Vector3, numbers_of, time_of
from app.api.schemas.texts import LongText
from app.services.alert_sightings import AlertSighting
from app.services.alert_words import MM_PER_M, advice_of, detail_of, distance_mm
from app.services.alerts import WatchedAlerts
from app.storage.alerts import Alert, AlertFigures, AlertKind, AlertState, Severity


class DisplacementAnswer(BaseModel):
    """Where a target stands less where the map has it."""

    vector_mm: Annotated[Vector3, Field(description="Of the target's centre, site axes.")]
    covariance_mm2: list[list[float]] = Field(description="3 x 3, site axes.")
    distance_mm: float
    sigma_mm: float = Field(description="Standard deviation of the distance.")

    @classmethod
    def of(cls, figures: AlertFigures) -> DisplacementAnswer | None:
        """The answer for an alert's figures; None when they hold no displacement."""
        distance = distance_mm(figures)
        if distance is None or figures.displacement_m is None or figures.covariance_m2 is None:
            return None
        return cls(
            vector_mm=[MM_PER_M * value_m for value_m in figures.displacement_m],
            covariance_mm2=[[MM_PER_M**2 * value for value in line] for line in figures.covariance_m2],
            distance_mm=distance[0],
            sigma_mm=distance[1],
        )


class AlertAnswer(BaseModel):
    """One trouble of a map version."""

    alert_id: str
    site_id: str
    map_version: int
    kind: AlertKind
    code: int | None = Field(description="The target; null when it is about the map.")
    severity: Severity = Field(description="critical: poses suffer now; warning: they will; notice: they do not.")
    state: AlertState
    detail: str
    advice: str
    displacement: DisplacementAnswer | None = Field(description="Of a moved target.")
    excess: float | None = Field(description="Test statistic over its limit: above 1 it counts.")
    since: str = Field(description="First snapshot that tells of it.")
    last: str = Field(description="Last snapshot that tells of it.")
    snapshots: int
    places: int = Field(description="Places that these snapshots were taken from.")
    devices: int
    raised_at: str
    acknowledged_at: str | None
    note: str = Field(description="Of whoever acknowledged it.")
    resolved_at: str | None

    @classmethod
    def of(cls, alert: Alert) -> AlertAnswer:
        """The answer for an alert."""
        trouble = alert.trouble
        return cls(
            alert_id=alert.alert_id,
            site_id=alert.site_id,
            map_version=alert.map_version,
            kind=trouble.kind,
            code=trouble.code,
            severity=trouble.severity,
            state=alert.state,
            detail=detail_of(alert),
            advice=advice_of(alert),
            displacement=DisplacementAnswer.of(trouble.figures),
            excess=trouble.figures.excess,
            since=time_of(trouble.since_s),
            last=time_of(trouble.last_s),
            snapshots=trouble.snapshots,
            places=trouble.places,
            devices=trouble.devices,
            raised_at=time_of(alert.raised_s),
            acknowledged_at=None if alert.acknowledged_s is None else time_of(alert.acknowledged_s),
            note=alert.note,
            resolved_at=None if alert.resolved_s is None else time_of(alert.resolved_s),
        )


class WatchedAnswer(BaseModel):
    """What alerts rest on."""

    map_version: int | None = Field(description="The active one; null without a map.")
    snapshots: int = Field(description="Located snapshots that were held against it.")


class AlertsAnswer(Listing):
    """A page of alerts."""

    alerts: list[AlertAnswer]
    watched: WatchedAnswer

    @classmethod
    def of(cls, found: WatchedAlerts) -> AlertsAnswer:
        """The answer for a page."""
        return cls(
            alerts=[AlertAnswer.of(alert) for alert in found.page.items],
            next_cursor=found.page.next_cursor,
            watched=WatchedAnswer(map_version=found.map_version, snapshots=found.snapshots),
        )


class SightingAnswer(BaseModel):
    """An alert's target in one snapshot."""

    pose_id: str
    trajectory_id: str
    captured_at: str
    device_id: str | None
    camera_m: Annotated[Vector3, Field(description="Where the snapshot was taken.")]
    movement_mm: Vector3 | None = Field(
        description="Of the target's centre against the map, site axes, by this snapshot alone; null: not in the map."
    )
    used: bool = Field(description="Whether the target carried the snapshot's pose.")

    @classmethod
    def of(cls, sighting: AlertSighting) -> SightingAnswer:
        """The answer for a sighting."""
        movement_m = sighting.movement_m
        return cls(
            pose_id=sighting.pose_id,
            trajectory_id=sighting.trajectory_id,
            captured_at=time_of(sighting.captured_s),
            device_id=sighting.device_id,
            camera_m=numbers_of(sighting.camera_m),
            movement_mm=None if movement_m is None else numbers_of(MM_PER_M * movement_m),
            used=sighting.used,
        )


class SightingsAnswer(BaseModel):
    """What an alert rests on, the newest first."""

    sightings: list[SightingAnswer]

    @classmethod
    def of(cls, sightings: tuple[AlertSighting, ...]) -> SightingsAnswer:
        """The answer for the sightings of an alert."""
        return cls(sightings=[SightingAnswer.of(sighting) for sighting in sightings])


class AcknowledgeBody(Body):
    """What whoever knows of an alert has to say."""

    note: LongText = ""
