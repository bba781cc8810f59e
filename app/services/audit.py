"""The audit: attempts that were refused are kept as well, and nothing is kept for ever."""

from __future__ import annotations

from app.storage.audit import REFUSED, Actor, AuditEntry, AuditRepository
from app.storage.database import Database


def note_refusal(database: Database, actor: Actor, action: str, subject: dict[str, str]) -> None:
    """Keep that somebody with a valid key wanted to change what is not theirs to change."""
    with database.writing() as session:
        AuditRepository(session).add(AuditEntry(actor, action, subject, REFUSED))
