"""When a smoothed trajectory is wanted, as the query says it."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

from fastapi import Depends, Query

from app.api.dependencies import PathId
from app.api.trajectory_queries import Times
from app.errors import InvalidInput
from app.services.capture_time import seconds_of
from app.services.smoothing_work import SmoothingWish

RATE = "So many poses a second, from the first one on."
MOMENTS = "Or these moments, increasing: ISO 8601 or epoch seconds, separated by commas."
GAP = "Between poses farther apart nothing is told."


def smoothing_wish(
    trajectory_id: PathId,
    times_range: Times,
    rate_hz: Annotated[float | None, Query(gt=0, le=1000, description=RATE)] = None,
    times: Annotated[str | None, Query(max_length=100_000, description=MOMENTS)] = None,
    max_gap_s: Annotated[float, Query(gt=0, le=60, description=GAP)] = 3.0,
) -> SmoothingWish:
    """When the trajectory is wanted."""
    moments_s = () if times is None else tuple(seconds_of(text, "times") for text in times.split(","))
    if any(later <= earlier for earlier, later in pairwise(moments_s)):
        raise InvalidInput("times must increase from one to the next", field="times")
    return SmoothingWish(trajectory_id, times_range, rate_hz, moments_s, max_gap_s)


SmoothingWished = Annotated[SmoothingWish, Depends(smoothing_wish)]
