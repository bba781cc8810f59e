"""A running system compared while its reference is being located."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator

from fastapi import APIRouter
from fastapi.sse import EventSourceResponse, ServerSentEvent

from app.api.dependencies import Id, Paging, PathId, ReadSession, Running, WriteSession
from app.api.live_queries import LiveStream, Opened
from app.api.problems import problems
from app.api.schemas.live_evaluations import (
    ErrorAnswer,
    ErrorEvent,
    KeptSamplesBody,
    LiveAnswer,
    LivesAnswer,
    LiveStateAnswer,
    SamplesAnswer,
    SamplesBody,
)
from app.api.schemas.trajectory_import import ImportAnswer
from app.api.security import Analysing, needs
from app.services.live_evaluation import close_live, take_samples
from app.services.live_events import error_so_far, watch_live
from app.services.live_samples import keep_samples
from app.storage.live_evaluations import LiveEvaluationRepository

router = APIRouter(tags=["live evaluations"])


@router.post("/evaluations/live", status_code=201, responses=problems(400, 404, 409, 413, 422))
def open_live_evaluation(live: Opened) -> LiveAnswer:
    """Begin to compare a running system with a trajectory that is being located."""
    answer: LiveAnswer = LiveAnswer.of(live)
    return answer


@router.get("/evaluations/live", responses=problems(404, 422))
def list_live_evaluations(
    page: Paging, session: ReadSession, principal: Analysing, site_id: Id | None = None
) -> LivesAnswer:
    """Live evaluations in the order they were opened."""
    return LivesAnswer.of(LiveEvaluationRepository(session).page(site_id, page, principal.site_ids))


@router.get("/evaluations/live/{live_id}", dependencies=[needs("analyse")], responses=problems(404, 422))
def get_live_evaluation(live_id: PathId, services: Running) -> LiveStateAnswer:
    """A live evaluation and the error so far."""
    live, tally = error_so_far(services.database, live_id)
    answer: LiveStateAnswer = LiveStateAnswer.of(live, error=ErrorAnswer.of(tally))
    return answer


@router.post(
    "/evaluations/live/{live_id}/samples",
    dependencies=[needs("locate", "analyse")],
    responses=problems(400, 404, 409, 413, 422, 503),
)
async def send_samples(live_id: PathId, body: SamplesBody, services: Running) -> SamplesAnswer:
    """Positions of the running system; safe to repeat, as each moment counts once."""
    samples = [sample.to_domain() for sample in body.samples]
    live, added = await asyncio.to_thread(take_samples, services.database, live_id, samples)
    services.bell.ring(live_id)
    return SamplesAnswer.of(live, len(samples), added)


@router.get(
    "/evaluations/live/{live_id}/events",
    dependencies=[needs("analyse")],
    response_class=EventSourceResponse,
    responses=problems(404, 422),
)
async def watch_error(wanted: LiveStream, services: Running) -> AsyncIterator[ServerSentEvent]:
    """The error so far after each new pair, as events ``error``; ``closed`` is the last."""
    async for news in watch_live(services.database, services.bell, wanted.live, wanted.after):
        event, number = ErrorEvent.of_news(news), str(news.number)
        if news.pair is None:
            yield ServerSentEvent(data=event, event="closed")
        else:
            yield ServerSentEvent(data=event, event="error", id=number)


@router.post("/evaluations/live/{live_id}/close", dependencies=[needs("analyse")], responses=problems(404, 422))
def close_live_evaluation(live_id: PathId, session: WriteSession) -> LiveAnswer:
    """Take no more samples; a closed one stays as it is."""
    answer: LiveAnswer = LiveAnswer.of(close_live(session, live_id))
    return answer


@router.post(
    "/evaluations/live/{live_id}/trajectory",
    status_code=201,
    dependencies=[needs("analyse")],
    responses=problems(400, 404, 409, 413, 422),
)
def keep_live_samples(live_id: PathId, session: WriteSession, body: KeptSamplesBody | None = None) -> ImportAnswer:
    """The samples as an imported trajectory, which POST /evaluations compares with every option."""
    return ImportAnswer.of(keep_samples(session, live_id, None if body is None else body.name))


@router.delete(
    "/evaluations/live/{live_id}", status_code=204, dependencies=[needs("analyse")], responses=problems(404, 422)
)
def delete_live_evaluation(live_id: PathId, session: WriteSession) -> None:
    """Remove a live evaluation with its samples."""
    LiveEvaluationRepository(session).remove(live_id)
