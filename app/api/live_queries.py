"""What of live evaluations is wanted, as the request says it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Header, Query

from app.api.dependencies import PathId, Running, WriteSession
from app.api.evaluation_wish import check_seen
from app.api.schemas.live_evaluations import NewLiveBody
from app.api.security import Analysing
from app.api.trajectory_queries import LAST
from app.services.live_evaluation import first_pair, open_live
from app.storage.live_evaluations import LiveEvaluationRepository
from app.storage.live_records import LiveEvaluation


def opened_live(body: NewLiveBody, session: WriteSession, principal: Analysing) -> LiveEvaluation:
    """A new live evaluation on a trajectory that the principal may see."""
    check_seen(session, principal, [body.reference_id])
    return open_live(session, body.reference_id, body.name or "", body.options.to_domain())


Opened = Annotated[LiveEvaluation, Depends(opened_live)]


@dataclass(frozen=True)
class LiveWanted:
    """A live evaluation that exists, and the pair after which its events begin."""

    live: LiveEvaluation
    after: int


def live_wanted(
    live_id: PathId,
    services: Running,
    last_event_id: Annotated[str | None, Header(description=LAST)] = None,
    last_event: Annotated[str | None, Query(alias="last_event_id", description="As the header.")] = None,
) -> LiveWanted:
    """Where a stream begins, found before it does."""
    with services.database.reading() as session:
        live = LiveEvaluationRepository(session).get(live_id)
    return LiveWanted(live, first_pair(live, last_event_id or last_event))


LiveStream = Annotated[LiveWanted, Depends(live_wanted)]
