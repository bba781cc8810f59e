"""Evaluations: made, listed, reported, removed."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Response

from app.api.dependencies import Id, Paging, PathId, ReadSession, Running, WriteSession
from app.api.evaluation_wish import Wished
from app.api.problems import problems
from app.api.report_answer import SECURITY
from app.api.schemas.evaluations import EvaluationAnswer, EvaluationsAnswer
from app.api.security import Analysing, needs
from app.storage.evaluations import EvaluationRepository

router = APIRouter(tags=["evaluations"])

MEDIA_TYPES = {"html": "text/html; charset=utf-8", "pdf": "application/pdf", "zip": "application/zip"}
FILES: dict[str, Any] = {"text/html": {}, "application/pdf": {}, "application/zip": {}}


@router.post("/evaluations", status_code=201, responses=problems(400, 404, 409, 413, 422, 503, 504))
async def evaluate(wish: Wished, services: Running) -> EvaluationAnswer:
    """Compare one system, or several, with a reference; what came out is kept."""
    return EvaluationAnswer.of(await services.evaluator.evaluate(wish))


@router.get("/evaluations", responses=problems(404, 422))
def list_evaluations(
    page: Paging, session: ReadSession, principal: Analysing, site_id: Id | None = None
) -> EvaluationsAnswer:
    """Evaluations in the order they were made."""
    return EvaluationsAnswer.of(EvaluationRepository(session).page(site_id, page, principal.site_ids))


@router.get(
    "/evaluations/{evaluation_id}",
    dependencies=[needs("analyse")],
    response_model=EvaluationAnswer,
    responses={200: {"content": FILES}, **problems(404, 422, 503, 504)},
)
async def get_evaluation(
    evaluation_id: PathId,
    services: Running,
    format: Annotated[Literal["json", "html", "pdf", "zip"], Query()] = "json",  # noqa: A002 - the query's name
) -> Any:
    """An evaluation: its numbers, or its report as a page, for print, or with all pairs for other tools."""
    if format == "json":
        return EvaluationAnswer.of(await services.evaluator.tell(evaluation_id))
    content = await services.evaluator.report(evaluation_id, format)
    name = f"scattermark-evaluation-{evaluation_id}.{format}"
    headers = {"Content-Disposition": f'inline; filename="{name}"', **SECURITY}
    return Response(content, media_type=MEDIA_TYPES[format], headers=headers)


@router.delete(
    "/evaluations/{evaluation_id}", status_code=204, dependencies=[needs("analyse")], responses=problems(404, 422)
)
def delete_evaluation(evaluation_id: PathId, session: WriteSession) -> None:
    """Remove an evaluation; its trajectories stay."""
    EvaluationRepository(session).remove(evaluation_id)
