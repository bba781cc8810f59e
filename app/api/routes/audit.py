"""Who changed what."""

from __future__ import annotations

from fastapi import APIRouter

from app.api.dependencies import Id, Paging, ReadSession
from app.api.problems import problems
from app.api.schemas.keys import AuditAnswer
from app.api.security import needs
from app.storage.audit import AuditRepository

router = APIRouter(tags=["audit"])


@router.get("/audit", responses=problems(404, 422), dependencies=[needs("admin")])
def list_audit(page: Paging, session: ReadSession, key_id: Id | None = None, site_id: Id | None = None) -> AuditAnswer:
    """Who changed what, the newest first; of one key or site when named. Snapshots stand in their trajectories."""
    return AuditAnswer.of(AuditRepository(session).page(page, key_id, site_id))
