"""Alerts in the database: one per trouble of a map version, raised, acknowledged, resolved, and raised again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal, cast

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from app.errors import NotFound
from app.storage.ids import new_id
from app.storage.models import AlertRow
from app.storage.paging import Page, PageRequest, page_of
from app.storage.sites import find_site_row
from app.storage.upsert import insert_if_absent

AlertState = Literal["open", "acknowledged", "resolved"]
AlertKind = Literal["moved-target", "misfit-target", "vanished-target", "unknown-target", "map-misfit"]
Severity = Literal["notice", "warning", "critical"]
STANDING: tuple[AlertState, ...] = ("open", "acknowledged")
WHOLE_MAP = "map"  # the subject of what is not about one target


@dataclass(frozen=True)
class AlertFigures:
    """Numbers of an alert.

    Attributes
    ----------
    displacement_m : tuple of float or None
        Of the target's centre, site axes: x, y, z.
    covariance_m2 : tuple of tuple of float or None
        3 x 3.
    excess : float or None
        Test statistic over its limit.
    """

    displacement_m: tuple[float, float, float] | None = None
    covariance_m2: tuple[tuple[float, ...], ...] | None = None
    excess: float | None = None


@dataclass(frozen=True)
class Trouble:
    """What is found wrong with a map.

    Attributes
    ----------
    code : int or None
        None when it is about the map.
    since_s, last_s : float
        First and last snapshot that tell of it, UTC seconds.
    snapshots, places, devices : int
    """

    kind: AlertKind
    code: int | None
    severity: Severity
    since_s: float
    last_s: float
    snapshots: int
    places: int
    devices: int
    figures: AlertFigures = AlertFigures()


@dataclass(frozen=True)
class Alert:
    """A trouble as it is kept.

    Attributes
    ----------
    raised_s : float
        When it was found.
    acknowledged_s, note : float or None, str
        When somebody said that it is known, and what about it.
    resolved_s : float or None
        When it was over.
    """

    alert_id: str
    site_id: str
    map_version: int
    state: AlertState
    trouble: Trouble
    raised_s: float
    acknowledged_s: float | None
    note: str
    resolved_s: float | None


@dataclass(frozen=True)
class AlertFilter:
    """Which alerts of a site are wanted; None: whatever."""

    site_id: str
    state: AlertState | None = None
    kind: AlertKind | None = None
    map_version: int | None = None


class AlertRepository:
    """Alerts of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def settle(self, site_id: str, map_version: int, troubles: Sequence[Trouble], now_s: float) -> None:
        """Keep what is found wrong with the active map of a site; what is found no more, or of other versions, is over.

        What was over and is found again is raised again, under its old id.
        """
        for trouble in troubles:
            self._keep(site_id, map_version, trouble, now_s)
        found = {(trouble.kind, _subject(trouble)) for trouble in troubles}
        standing = select(AlertRow).where(AlertRow.site_id == site_id, AlertRow.state.in_(STANDING))
        for row in self._session.scalars(standing):
            if row.map_version != map_version or (row.kind, row.subject) not in found:
                row.state, row.resolved_s = "resolved", now_s
        self._session.flush()

    def get(self, alert_id: str) -> Alert:
        """One alert.

        Raises
        ------
        NotFound
        """
        row = self._session.get(AlertRow, alert_id)
        if row is None:
            raise NotFound(f"there is no alert {alert_id}; GET /sites/{{site_id}}/alerts lists them", alert_id=alert_id)
        return _alert(row)

    def page(self, wanted: AlertFilter, request: PageRequest) -> Page[Alert]:
        """Alerts of a site, the newest first.

        Raises
        ------
        NotFound
            When there is no such site.
        """
        find_site_row(self._session, wanted.site_id)
        query = select(AlertRow).where(AlertRow.site_id == wanted.site_id).order_by(AlertRow.id.desc())
        for column, value in (
            (AlertRow.state, wanted.state),
            (AlertRow.kind, wanted.kind),
            (AlertRow.map_version, wanted.map_version),
        ):
            query = query if value is None else query.where(column == value)
        if request.after is not None:
            query = query.where(AlertRow.id < request.after)
        rows = self._session.scalars(query.limit(request.limit + 1))
        return page_of([(row.id, _alert(row)) for row in rows], request.limit)

    def acknowledge(self, alert_id: str, note: str, now_s: float) -> Alert:
        """Say that an open alert is known; one that is acknowledged gets the new note, one that is over stays so.

        Raises
        ------
        NotFound
        """
        standing = update(AlertRow).where(AlertRow.id == alert_id, AlertRow.state.in_(STANDING))
        self._session.execute(standing.values(state="acknowledged", acknowledged_s=now_s, note=note))
        return self.get(alert_id)

    def _keep(self, site_id: str, map_version: int, trouble: Trouble, now_s: float) -> None:
        key = {"site_id": site_id, "map_version": map_version, "kind": trouble.kind, "subject": _subject(trouble)}
        fresh = {"state": "open", "raised_s": now_s, "acknowledged_s": None, "note": "", "resolved_s": None}
        values = _values(trouble)
        if insert_if_absent(self._session, AlertRow, id=new_id(), **key, **fresh, **values):
            return
        row = self._session.scalars(select(AlertRow).filter_by(**key)).one()
        for name, value in {**values, **(fresh if row.state == "resolved" else {})}.items():
            setattr(row, name, value)


def _subject(trouble: Trouble) -> str:
    return WHOLE_MAP if trouble.code is None else str(trouble.code)


def _values(trouble: Trouble) -> dict[str, Any]:
    return {
        "code": trouble.code,
        "severity": trouble.severity,
        "since_s": trouble.since_s,
        "last_s": trouble.last_s,
        "snapshot_count": trouble.snapshots,
        "place_count": trouble.places,
        "device_count": trouble.devices,
        "figures": asdict(trouble.figures),
    }


def _alert(row: AlertRow) -> Alert:
    figures = row.figures
    moved, spread = figures["displacement_m"], figures["covariance_m2"]
    trouble = Trouble(
        kind=cast(AlertKind, row.kind),
        code=row.code,
        severity=cast(Severity, row.severity),
        since_s=row.since_s,
        last_s=row.last_s,
        snapshots=row.snapshot_count,
        places=row.place_count,
        devices=row.device_count,
        figures=AlertFigures(
            None if moved is None else (moved[0], moved[1], moved[2]),
            None if spread is None else tuple(tuple(line) for line in spread),
            figures["excess"],
        ),
    )
    return Alert(
        alert_id=row.id,
        site_id=row.site_id,
        map_version=row.map_version,
        state=cast(AlertState, row.state),
        trouble=trouble,
        raised_s=row.raised_s,
        acknowledged_s=row.acknowledged_s,
        note=row.note,
        resolved_s=row.resolved_s,
    )
