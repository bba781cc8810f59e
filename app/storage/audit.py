"""Who changed what: a row that is written in the very transaction that makes the change.

``noting`` says who acts; every writing session of ``Database`` that is opened meanwhile, in whatever thread, then signs
its transaction before it is committed. Nobody has to think of it, and nothing is changed without a row.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from typing import Any, Literal, cast

from sqlalchemy import delete, event, select
from sqlalchemy.orm import Session, UOWTransaction

from app.storage.ids import new_id
from app.storage.models import (
    AuditRow,
    Base,
    CameraRow,
    EvaluationRow,
    JobRow,
    KeyRow,
    LiveEvaluationRow,
    SiteRow,
    SurveyRow,
    TrajectoryRow,
)
from app.storage.paging import Page, PageRequest, page_of

Outcome = Literal["done", "refused"]
DONE: Outcome = "done"
REFUSED: Outcome = "refused"
GREATEST_TEXT = 200  # of a column; a photograph's name in a path may be longer
IDS: dict[type[Base], str] = {
    SiteRow: "site_id",
    SurveyRow: "survey_id",
    JobRow: "job_id",
    TrajectoryRow: "trajectory_id",
    CameraRow: "camera_id",
    KeyRow: "key_id",
    EvaluationRow: "evaluation_id",
    LiveEvaluationRow: "live_id",
}


@dataclass(frozen=True)
class Actor:
    """Who acts: a key's id and name, where from, and the id under which the log tells more."""

    key_id: str | None
    name: str
    address: str
    request_id: str | None = None


@dataclass(frozen=True)
class AuditEntry:
    """One change, or one attempt that was refused.

    Attributes
    ----------
    action : str
        Such as ``PATCH /sites/{site_id}`` or ``keys create``.
    subject : dict
        Ids of what was named and of what was made.
    """

    actor: Actor
    action: str
    subject: dict[str, str]
    outcome: Outcome
    entry_id: str = field(default_factory=new_id)
    at_s: float = field(default_factory=time.time)


class PendingEntry:
    """A row that waits for the first transaction that changes something."""

    def __init__(self, actor: Actor, action: str, subject: dict[str, str]) -> None:
        self._actor = actor
        self._action = action
        self._subject = {name: text[:GREATEST_TEXT] for name, text in subject.items()}
        self.written = False

    def identify(self, key_id: str, name: str) -> None:
        """Say who it is, once it is known."""
        self._actor = replace(self._actor, key_id=key_id, name=name)

    def with_made(self, made: dict[str, str]) -> AuditEntry:
        """The row's content, once it is known what the transaction made."""
        return AuditEntry(self._actor, self._action, {**made, **self._subject}, DONE)


_pending: ContextVar[PendingEntry | None] = ContextVar("pending_audit_entry", default=None)


@contextmanager
def noting(actor: Actor, action: str, subject: dict[str, str]) -> Iterator[None]:
    """Until the block ends, the first transaction that is committed is this actor's doing."""
    token = _pending.set(PendingEntry(actor, action, subject))
    try:
        yield
    finally:
        _pending.reset(token)


def expect_change(actor: Actor, action: str, subject: dict[str, str]) -> None:
    """``noting`` until the end of the present task, such as a request's."""
    _pending.set(PendingEntry(actor, action, subject))


def waiting_entry() -> PendingEntry | None:
    """The row that waits in the present task, for a process that makes the change in its place."""
    return _pending.get()


@contextmanager
def on_behalf_of(waiting: PendingEntry | None) -> Iterator[None]:
    """Until the block ends, the first transaction is that of another process's task, whose waiting row it gets."""
    token = _pending.set(waiting)
    try:
        yield
    finally:
        _pending.reset(token)


def identify(key_id: str, name: str) -> None:
    """Say which key's doing the present task's change is, when it came out only now."""
    pending = _pending.get()
    if pending is not None:
        pending.identify(key_id, name)


@contextmanager
def signing(session: Session) -> Iterator[None]:
    """Add the row that waits, if any, to what a session has done when the block ends.

    Who acts is asked then: a request's session may be opened before its key is looked at.
    """
    made: dict[str, str] = {}

    def collect(flushed: Session, _context: UOWTransaction) -> None:
        for row in flushed.new:
            if type(row) in IDS:
                made.update(_ids_of(row))

    event.listen(session, "after_flush", collect)
    yield
    pending = _pending.get()
    if pending is not None and not pending.written:
        session.flush()
        AuditRepository(session).add(pending.with_made(made))
        pending.written = True


def _ids_of(row: Any) -> dict[str, str]:
    of_site = getattr(row, "site_id", None)
    return {**({} if of_site is None else {"site_id": of_site}), IDS[type(row)]: row.id}


class AuditRepository:
    """Audit rows of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, entry: AuditEntry) -> None:
        """Keep an entry."""
        row = AuditRow(
            id=entry.entry_id,
            at_s=entry.at_s,
            key_id=entry.actor.key_id,
            name=entry.actor.name,
            address=entry.actor.address,
            request_id=entry.actor.request_id,
            action=entry.action,
            site_id=entry.subject.get("site_id"),
            subject=entry.subject,
            outcome=entry.outcome,
        )
        self._session.add(row)

    def page(self, request: PageRequest, key_id: str | None = None, site_id: str | None = None) -> Page[AuditEntry]:
        """Entries from the newest to the oldest, of one key or site when named."""
        query = select(AuditRow).order_by(AuditRow.id.desc()).limit(request.limit + 1)
        if key_id is not None:
            query = query.where(AuditRow.key_id == key_id)
        if site_id is not None:
            query = query.where(AuditRow.site_id == site_id)
        if request.after is not None:
            query = query.where(AuditRow.id < request.after)
        return page_of([(row.id, _entry(row)) for row in self._session.scalars(query)], request.limit)

    def remove_before(self, time_s: float) -> None:
        """Forget what is older."""
        self._session.execute(delete(AuditRow).where(AuditRow.at_s < time_s))


def _entry(row: AuditRow) -> AuditEntry:
    actor = Actor(row.key_id, row.name, row.address, row.request_id)
    return AuditEntry(actor, row.action, dict(row.subject), cast(Outcome, row.outcome), row.id, row.at_s)
