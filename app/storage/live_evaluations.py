"""Live evaluations in the database: all their state, so that any server can take samples and tell errors."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from sqlalchemy import bindparam, select, update
from sqlalchemy.orm import Session

from app.errors import Conflict, NotFound
from app.storage.belonging import within
from app.storage.ids import new_id
from app.storage.live_records import LiveEvaluation, LiveOptions, LivePair, Sample
from app.storage.models import LiveEvaluationRow, LiveSampleRow
from app.storage.paging import Page, PageRequest, page_of
from app.storage.upsert import insert_what_is_absent

WAITING, PAIRED, MISSED = "waiting", "paired", "missed"
ROWS_AT_A_TIME = 2000


class LiveEvaluationRepository:
    """Live evaluations of one session."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def add(self, site_id: str, reference_id: str, name: str, options: LiveOptions) -> LiveEvaluation:
        """A new one without samples."""
        counts = dict.fromkeys(("sample_count", "pair_count", "missed_count", "seen_ordinal"), 0)
        row = LiveEvaluationRow(
            id=new_id(),
            site_id=site_id,
            reference_id=reference_id,
            name=name,
            options=asdict(options),
            created_s=time.time(),
            closed_s=None,
            **counts,
        )
        self._session.add(row)
        self._session.flush()
        return _stored(row)

    def get(self, live_id: str, *, lock: bool = False) -> LiveEvaluation:
        """One live evaluation; locked, it stays as it is until the transaction ends.

        Raises
        ------
        NotFound
        """
        return _stored(self._row(live_id, lock=lock))

    def page(
        self, site_id: str | None, request: PageRequest, site_ids: Collection[str] | None = None
    ) -> Page[LiveEvaluation]:
        """Live evaluations in the order they were opened; of one site when named, of these sites alone if given."""
        query = select(LiveEvaluationRow).where(within(LiveEvaluationRow.site_id, site_ids))
        if site_id is not None:
            query = query.where(LiveEvaluationRow.site_id == site_id)
        if request.after is not None:
            query = query.where(LiveEvaluationRow.id > request.after)
        rows = self._session.scalars(query.order_by(LiveEvaluationRow.id).limit(request.limit + 1)).all()
        return page_of([(row.id, _stored(row)) for row in rows], request.limit)

    def add_samples(self, live_id: str, samples: Sequence[Sample]) -> int:
        """Add those samples whose moment has none yet; how many they were.

        Raises
        ------
        NotFound
        Conflict
            When it is closed.
        """
        row = self._row(live_id, lock=True)
        if row.closed_s is not None:
            raise Conflict(f"live evaluation {live_id} is closed; open another one", live_id=live_id)
        rows = [
            {"id": new_id(), "live_id": live_id, "state": WAITING, **asdict(sample)}
            for sample in {sample.time_s: sample for sample in reversed(samples)}.values()  # the first of a moment
        ]
        added = insert_what_is_absent(self._session.connection(), LiveSampleRow, rows) if rows else 0
        row.sample_count += added
        self._session.flush()
        return added

    def waiting(self, live_id: str, limit: int) -> list[tuple[str, Sample]]:
        """Samples without a pair yet in the order of time, by id."""
        query = select(LiveSampleRow).where(LiveSampleRow.live_id == live_id, LiveSampleRow.state == WAITING)
        rows = self._session.scalars(query.order_by(LiveSampleRow.time_s).limit(limit))
        return [(row.id, _sample(row)) for row in rows]

    def samples(self, live_id: str) -> list[Sample]:
        """All samples in the order of time."""
        query = select(LiveSampleRow).where(LiveSampleRow.live_id == live_id).order_by(LiveSampleRow.time_s)
        found = []
        for row in self._session.scalars(query.execution_options(yield_per=ROWS_AT_A_TIME)):
            found.append(_sample(row))
            self._session.expunge(row)  # a hundred thousand samples shall not stay with the session
        return found

    def settle(self, live_id: str, pairs: Mapping[str, LivePair], missed: Sequence[str], seen_ordinal: int) -> None:
        """Keep what became of waiting samples; the live evaluation is locked already."""
        row = self._row(live_id)
        changes = [
            {"sample_id": sample_id, "new_state": PAIRED, "number": row.pair_count + place, **_columns(pair)}
            for place, (sample_id, pair) in enumerate(pairs.items(), start=1)
        ]
        if changes:
            self._session.connection().execute(_PAIR, changes)
        if missed:
            self._session.connection().execute(_MISS, [{"sample_id": sample_id} for sample_id in missed])
        row.pair_count += len(pairs)
        row.missed_count += len(missed)
        row.seen_ordinal = seen_ordinal
        self._session.flush()

    def pairs(self, live_id: str, after: int, limit: int) -> list[tuple[int, LivePair]]:
        """Pairs that follow one, in the order in which they were found, by number."""
        query = select(LiveSampleRow).where(LiveSampleRow.live_id == live_id, LiveSampleRow.pair > after)
        rows = self._session.scalars(query.order_by(LiveSampleRow.pair).limit(limit))
        return [(row.pair, _pair(row)) for row in rows if row.pair is not None]

    def close(self, live_id: str) -> LiveEvaluation:
        """Take no more samples."""
        row = self._row(live_id, lock=True)
        row.closed_s = row.closed_s or time.time()
        self._session.flush()
        return _stored(row)

    def remove(self, live_id: str) -> None:
        """Remove a live evaluation with its samples.

        Raises
        ------
        NotFound
        """
        self._session.delete(self._row(live_id, lock=True))
        self._session.flush()

    def _row(self, live_id: str, *, lock: bool = False) -> LiveEvaluationRow:
        row = self._session.get(LiveEvaluationRow, live_id, with_for_update=lock, populate_existing=lock)
        if row is None:
            raise NotFound(f"there is no live evaluation {live_id}; POST /evaluations/live opens one", live_id=live_id)
        return row


_SAMPLES: Any = LiveSampleRow.__table__
_NAMED = _SAMPLES.c.id == bindparam("sample_id")
_ERRORS = ("error_x_m", "error_y_m", "error_z_m", "angle_rad", "reference_sigma_m", "right_floor")
_PAIR = update(_SAMPLES).where(_NAMED)
_PAIR = _PAIR.values(
    state=bindparam("new_state"), pair=bindparam("number"), **{name: bindparam(f"new_{name}") for name in _ERRORS}
)
_MISS = update(_SAMPLES).where(_NAMED).values(state=MISSED)


def _columns(pair: LivePair) -> dict[str, Any]:
    values = (*pair.error_m, pair.angle_rad, pair.reference_sigma_m, pair.right_floor)
    return {f"new_{name}": value for name, value in zip(_ERRORS, values, strict=True)}


def _pair(row: LiveSampleRow) -> LivePair:
    assert row.error_x_m is not None and row.error_y_m is not None, "a pair has an error"
    error_m = (row.error_x_m, row.error_y_m, row.error_z_m)
    return LivePair(
        time_s=row.time_s,
        position_m=(row.x_m, row.y_m, row.z_m),
        error_m=error_m,
        angle_rad=row.angle_rad,
        reference_sigma_m=row.reference_sigma_m,
        right_floor=row.right_floor,
        arrived_s=row.arrived_s,
    )


def _sample(row: LiveSampleRow) -> Sample:
    turn = row.orientation_xyzw
    orientation = None if turn is None else (turn[0], turn[1], turn[2], turn[3])
    return Sample(row.time_s, row.x_m, row.y_m, row.z_m, row.floor, orientation, row.arrived_s)


def _stored(row: LiveEvaluationRow) -> LiveEvaluation:
    arm_m = row.options["lever_arm_m"]
    options = {**row.options, "lever_arm_m": None if arm_m is None else tuple(arm_m)}
    return LiveEvaluation(
        live_id=row.id,
        site_id=row.site_id,
        reference_id=row.reference_id,
        name=row.name,
        options=LiveOptions(**options),
        created_s=row.created_s,
        closed_s=row.closed_s,
        sample_count=row.sample_count,
        pair_count=row.pair_count,
        missed_count=row.missed_count,
        seen_ordinal=row.seen_ordinal,
    )
