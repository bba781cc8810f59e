"""What photographs take, for operators."""

from __future__ import annotations

from fastapi import APIRouter

from app.api.dependencies import Running
from app.api.problems import problems
from app.api.schemas.storage import StorageAnswer
from app.api.security import needs

router = APIRouter(tags=["operations"])


@router.get("/storage", dependencies=[needs("admin")], responses=problems(503))
def get_storage(services: Running) -> StorageAnswer:
    """Bytes that photographs take, in total and by site, beside what they may take."""
    return StorageAnswer.of(services.budget.usage())
