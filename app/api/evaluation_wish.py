"""What is to be evaluated, as a body says it; trajectories of sites that a key may not see do not exist for it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated

from fastapi import Depends

from app.api.dependencies import ReadSession
from app.api.schemas.evaluations import EvaluationBody
from app.api.security import Analysing
from app.services.evaluate_work import EvaluationWish
from app.services.principal import Principal
from app.storage.belonging import site_of
from app.storage.database import Session
from app.storage.trajectory_rows import no_trajectory


def evaluation_wish(body: EvaluationBody, session: ReadSession, principal: Analysing) -> EvaluationWish:
    """What is to be evaluated."""
    wish = body.to_domain()
    check_seen(session, principal, (wish.reference_id, *wish.estimate_ids))
    return wish


Wished = Annotated[EvaluationWish, Depends(evaluation_wish)]


def check_seen(session: Session, principal: Principal, trajectory_ids: Iterable[str]) -> None:
    """See that trajectories exist for a principal.

    Raises
    ------
    NotFound
        For one that does not, or is of a site that is none of theirs.
    """
    for trajectory_id in trajectory_ids:
        site_id = site_of(session, "trajectory_id", trajectory_id)
        if site_id is None or not principal.sees(site_id):
            raise no_trajectory(trajectory_id)
