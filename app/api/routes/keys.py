"""Keys: made, listed, revoked, by whoever administers."""

from __future__ import annotations

from fastapi import APIRouter, Response

from app.api.dependencies import Paging, PathId, ReadSession, Running, WriteSession
from app.api.problems import problems
from app.api.schemas.keys import IssuedKeyAnswer, KeyAnswer, KeysAnswer, NewKeyBody
from app.api.security import needs
from app.services.keys import create_key
from app.storage.keys import KeyRepository

router = APIRouter(tags=["keys"], dependencies=[needs("admin")])

UNSEEN = {"Cache-Control": "no-store"}  # nobody between keeps a secret


@router.post("/keys", status_code=201, responses=problems(400, 404, 413, 422))
def post_key(body: NewKeyBody, session: WriteSession, response: Response) -> IssuedKeyAnswer:
    """Make a key; its secret is in this answer and nowhere else."""
    response.headers.update(UNSEEN)
    return IssuedKeyAnswer.of_issued(create_key(session, body.to_domain()))


@router.get("/keys", responses=problems(422))
def list_keys(page: Paging, session: ReadSession) -> KeysAnswer:
    """All keys in the order they were made, revoked and expired ones included."""
    return KeysAnswer.of(KeyRepository(session).page(page))


@router.get("/keys/{key_id}", responses=problems(404, 422))
def get_key(key_id: PathId, session: ReadSession) -> KeyAnswer:
    """One key."""
    return KeyAnswer.of(KeyRepository(session).get(key_id))


@router.delete("/keys/{key_id}", responses=problems(404, 422))
async def delete_key(key_id: PathId, services: Running) -> KeyAnswer:
    """Revoke a key and end its sessions: here at once, in other processes within seconds. It stays in the list."""
    return KeyAnswer.of(await services.gatekeeper.revoke(key_id))
