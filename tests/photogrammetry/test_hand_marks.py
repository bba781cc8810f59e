"""Marks override dots, add to targets, or make targets of four and more."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.geometry.marks import Mark
from app.geometry.observations import Detection, TargetObservation
from app.photogrammetry.hand_marks import FEWEST_MARKS, with_marks
from app.targets.layout import DOT_COUNT, dot_centres_u

PLACES_PX = dot_centres_u() * (7.0, -6.0) + (320.0, 240.0)
SEEN = TargetObservation(
    389, PLACES_PX, np.tile(0.01 * np.eye(2), (DOT_COUNT, 1, 1)), np.arange(DOT_COUNT) != 3, corrected=1, rms_px=0.05
)
PHOTO = Detection(640, 480, (SEEN,))
CORNERS = (0, 3, 12, 15)


def marks(code: int, *cells: int) -> list[Mark]:
    return [Mark(code, cell, PLACES_PX[cell], 0.4) for cell in cells]


def test_a_mark_overrides_a_dot_and_adds_one() -> None:
    moved = Mark(389, 7, np.array([1.0, 2.0]), 0.3)
    (target,) = with_marks(PHOTO, [moved, *marks(389, 3)]).targets
    assert target.measured.all()
    assert target.centres_px[7] == pytest.approx([1.0, 2.0])
    assert target.covariances_px2[7] == pytest.approx(0.09 * np.eye(2))
    others = [cell for cell in range(DOT_COUNT) if cell not in (3, 7)]
    assert np.array_equal(target.centres_px[others], SEEN.centres_px[others])
    assert (target.corrected, target.rms_px) == (SEEN.corrected, SEEN.rms_px)
    assert not SEEN.measured[3], "what was given stays as it was"


@given(st.sets(st.integers(0, DOT_COUNT - 1), min_size=1))
def test_marks_alone_make_a_target_when_they_span_a_plane(cells: set[int]) -> None:
    made = with_marks(Detection(640, 480, ()), marks(694, *cells)).targets
    rows, columns = np.divmod(sorted(cells), 4)
    offsets = np.stack([rows - rows[0], columns - columns[0]])
    in_line = all(a * d == b * c for a, b in offsets.T for c, d in offsets.T)
    assert len(made) == (len(cells) >= FEWEST_MARKS and not in_line)
    if made:
        assert set(np.flatnonzero(made[0].measured)) == cells
        assert made[0].centres_px == pytest.approx(PLACES_PX), "an affine picture is drawn exactly"


def test_codes_stay_unique_and_others_stay() -> None:
    both = with_marks(PHOTO, [*marks(694, *CORNERS), *marks(889, 1, 2)])
    assert [target.code for target in both.targets] == [389, 694]
    assert with_marks(PHOTO, ()) == PHOTO or with_marks(PHOTO, ()).targets == PHOTO.targets
