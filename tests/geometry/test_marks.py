"""A mark is checked at birth."""

from __future__ import annotations

import numpy as np
import pytest

from app.geometry.marks import HAND_SIGMA_PX, Mark


@pytest.mark.parametrize(
    "faulty", [{"cell": 16}, {"position_px": np.array([np.nan, 1.0])}, {"sigma_px": 0.0}, {"position_px": np.ones(3)}]
)
def test_what_cannot_be_right_is_refused(faulty: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"mark|cells"):
        Mark(**{"code": 389, "cell": 0, "position_px": np.ones(2), **faulty})  # type: ignore[arg-type]


def test_a_hand_has_its_own_sigma() -> None:
    assert Mark(389, 0, np.ones(2)).sigma_px == HAND_SIGMA_PX
