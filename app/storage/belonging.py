"""Which site a thing belongs to, for keys that are bound to sites."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from sqlalchemy import ColumnElement, select, true
from sqlalchemy.orm import InstrumentedAttribute, Session

from app.storage.models import (
    AlertRow,
    Base,
    CameraRow,
    EvaluationRow,
    JobRow,
    LiveEvaluationRow,
    SnapshotRow,
    SurveyRow,
    TrajectoryRow,
)

# By the names that ids have in addresses.
OWNED: dict[str, type[Base]] = {
    "survey_id": SurveyRow,
    "job_id": JobRow,
    "trajectory_id": TrajectoryRow,
    "camera_id": CameraRow,
    "pose_id": SnapshotRow,
    "evaluation_id": EvaluationRow,
    "live_id": LiveEvaluationRow,
    "alert_id": AlertRow,
}


def site_of(session: Session, id_name: str, identifier: str) -> str | None:
    """The site that something with an id of its own belongs to; None when there is no such thing."""
    if id_name == "site_id":
        return identifier
    table: Any = OWNED[id_name]
    found = session.scalar(select(table.site_id).where(table.id == identifier))
    return None if found is None else str(found)


def within(site_id: InstrumentedAttribute[Any], site_ids: Collection[str] | None) -> ColumnElement[bool]:
    """The condition that a row belongs to one of these sites, or to any for None."""
    return true() if site_ids is None else site_id.in_(sorted(site_ids))
