"""Evaluations in the database: made once, never changed."""

from __future__ import annotations

import time
from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from app.errors import NotFound
from app.storage.belonging import within
from app.storage.blobs import array_of_blob, blob_of_array
from app.storage.evaluation_records import EvaluatedSystem, NewEvaluation, StoredEvaluation
from app.storage.ids import new_id
from app.storage.models import EvaluatedPosesRow, EvaluatedSystemRow, EvaluationRow
from app.storage.paging import Page, PageRequest, page_of
from app.storage.pose_blobs import joined, pieces_of, pose_columns, poses_of_row
from app.trajectories.association import Pairs
from app.trajectories.trajectory import Trajectory

REFERENCE, ESTIMATE = "reference", "estimate"


class EvaluationRepository:
    """Evaluations of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, new: NewEvaluation) -> StoredEvaluation:
        """Keep an evaluation."""
        row = EvaluationRow(
            id=new_id(),
            site_id=new.site_id,
            reference_id=new.reference_id,
            reference_name=new.reference_name,
            title=new.title,
            options=new.options,
            differences=new.differences,
            created_s=time.time(),
        )
        self._session.add(row)
        self._session.flush()
        for ordinal, (system, pairs) in enumerate(zip(new.systems, new.pairs, strict=True)):
            self._session.add(_system_row(row.id, ordinal, system))
            self._add_pairs(row.id, ordinal, pairs)
        self._session.flush()
        return _stored(row, new.systems)

    def get(self, evaluation_id: str) -> StoredEvaluation:
        """One evaluation.

        Raises
        ------
        NotFound
        """
        row = self._session.get(EvaluationRow, evaluation_id)
        if row is None:
            raise _no_evaluation(evaluation_id)
        return _stored(row, self._systems([row.id]).get(row.id, ()))

    def page(
        self, site_id: str | None, request: PageRequest, site_ids: Collection[str] | None = None
    ) -> Page[StoredEvaluation]:
        """Evaluations in the order they were made; of one site when named, of these sites alone if given."""
        query = select(EvaluationRow).where(within(EvaluationRow.site_id, site_ids))
        if site_id is not None:
            query = query.where(EvaluationRow.site_id == site_id)
        if request.after is not None:
            query = query.where(EvaluationRow.id > request.after)
        rows = self._session.scalars(query.order_by(EvaluationRow.id).limit(request.limit + 1)).all()
        systems = self._systems([row.id for row in rows])
        return page_of([(row.id, _stored(row, systems.get(row.id, ()))) for row in rows], request.limit)

    def pairs(self, evaluation_id: str, system: int) -> Pairs:
        """The pairs of a system of an evaluation that exists, aligned."""
        found = self._session.get_one(EvaluatedSystemRow, (evaluation_id, system))
        reference, _ = self._side(evaluation_id, system, REFERENCE)
        estimate, rows = self._side(evaluation_id, system, ESTIMATE)
        return Pairs(reference, estimate, np.concatenate(rows).astype(np.intp), found.record["estimate_poses"])

    def remove(self, evaluation_id: str) -> None:
        """Remove an evaluation; its trajectories stay.

        Raises
        ------
        NotFound
        """
        removed = self._session.execute(
            delete(EvaluationRow).where(EvaluationRow.id == evaluation_id).returning(EvaluationRow.id)
        )
        if removed.first() is None:
            raise _no_evaluation(evaluation_id)

    def _add_pairs(self, evaluation_id: str, system: int, pairs: Pairs) -> None:
        for side, poses in ((REFERENCE, pairs.reference), (ESTIMATE, pairs.estimate)):
            for first, piece in pieces_of(poses):
                rows = pairs.estimate_rows[first : first + len(piece)].astype(np.float64)
                row = EvaluatedPosesRow(
                    evaluation_id=evaluation_id,
                    system=system,
                    side=side,
                    ordinal=first + 1,
                    estimate_rows=blob_of_array(rows) if side == ESTIMATE else None,
                    **pose_columns(piece),
                )
                self._session.add(row)
                self._session.flush()
                self._session.expunge(row)  # a million pairs shall not stay with the session

    def _side(self, evaluation_id: str, system: int, side: str) -> tuple[Trajectory, list[Any]]:
        query = select(EvaluatedPosesRow).where(
            EvaluatedPosesRow.evaluation_id == evaluation_id,
            EvaluatedPosesRow.system == system,
            EvaluatedPosesRow.side == side,
        )
        pieces, rows = [], []
        for row in self._session.scalars(query.order_by(EvaluatedPosesRow.ordinal)):
            pieces.append(poses_of_row(row))
            rows += [] if row.estimate_rows is None else [array_of_blob(row.estimate_rows, row.pose_count)]
            self._session.expunge(row)
        return joined(pieces), rows

    def _systems(self, evaluation_ids: Sequence[str]) -> dict[str, tuple[EvaluatedSystem, ...]]:
        query = select(EvaluatedSystemRow).where(EvaluatedSystemRow.evaluation_id.in_(evaluation_ids))
        found: dict[str, tuple[EvaluatedSystem, ...]] = {}
        for row in self._session.scalars(query.order_by(EvaluatedSystemRow.ordinal)):
            system = EvaluatedSystem(row.trajectory_id, row.name, row.record)
            found[row.evaluation_id] = (*found.get(row.evaluation_id, ()), system)
        return found


def _system_row(evaluation_id: str, ordinal: int, system: EvaluatedSystem) -> EvaluatedSystemRow:
    return EvaluatedSystemRow(
        evaluation_id=evaluation_id,
        ordinal=ordinal,
        trajectory_id=system.trajectory_id,
        name=system.name,
        record=system.record,
    )


def _stored(row: EvaluationRow, systems: tuple[EvaluatedSystem, ...]) -> StoredEvaluation:
    return StoredEvaluation(
        evaluation_id=row.id,
        site_id=row.site_id,
        reference_id=row.reference_id,
        reference_name=row.reference_name,
        title=row.title,
        options=row.options,
        differences=row.differences,
        systems=systems,
        created_s=row.created_s,
    )


def _no_evaluation(evaluation_id: str) -> NotFound:
    return NotFound(f"there is no evaluation {evaluation_id}; GET /evaluations lists them", evaluation_id=evaluation_id)
