"""APE and RPE by their laws; their numbers are held against evo's in test_with_evo.py."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from app.errors import InvalidInput
from app.geometry.similarity import Similarity
from app.trajectories.alignment import Alignment
from app.trajectories.association import AssociationOptions, associate
from app.trajectories.metrics.absolute_pose_error import absolute_pose_errors
from app.trajectories.metrics.pose_errors import pose_errors_of
from app.trajectories.metrics.relative_pose_error import Stretch, relative_pose_errors
from app.trajectories.trajectory import Trajectory
from tests.trajectories.walks import walk

EXACT = AssociationOptions("nearest", max_gap_s=0.0)
ELSEWHERE = Alignment(
    "se3", Similarity(1.0, Rotation.from_rotvec([0.1, 1.0, -2.0]).as_matrix(), np.array([5.0, 6.0, 7.0])), 0
)


def test_relative_errors_do_not_see_another_frame_and_absolute_ones_do() -> None:
    true = walk(20.0, 5.0)
    pairs = associate(true, ELSEWHERE.apply(true), EXACT)
    for part in ("trans", "rot_rad", "full"):
        for stretch in (Stretch(3), Stretch(1.5, "metres"), Stretch(2.0, "seconds", all_pairs=True)):
            assert relative_pose_errors(pairs, part, stretch).values.max() < 1e-6  # type: ignore[arg-type]
        assert absolute_pose_errors(pairs, part).min() > 0.1  # type: ignore[arg-type]


def test_a_drift_shows_by_the_stretch() -> None:
    true = walk(20.0, 5.0)
    drift = np.outer(true.times_s - true.times_s[0], [0.01, 0.0, 0.0])
    pairs = associate(true, Trajectory(true.times_s, true.positions_m + drift, true.orientations_xyzw), EXACT)
    for seconds in (1.0, 2.0):
        found = relative_pose_errors(pairs, "trans", Stretch(seconds, "seconds", all_pairs=True))
        np.testing.assert_allclose(found.values, 0.01 * seconds, rtol=1e-3)
        # Consecutive stretches cover the walk without a hole.
        chain = relative_pose_errors(pairs, "trans", Stretch(seconds, "seconds"))
        np.testing.assert_array_equal(chain.starts[1:], chain.ends[:-1])


def test_degrees_are_degrees() -> None:
    true = walk(5.0)
    pairs = associate(true, ELSEWHERE.apply(true), EXACT)
    np.testing.assert_allclose(
        absolute_pose_errors(pairs, "rot_deg"), np.degrees(absolute_pose_errors(pairs, "rot_rad"))
    )


def test_what_cannot_be_had_is_refused() -> None:
    true = walk(2.0)
    positions = Trajectory(true.times_s, true.positions_m)
    with pytest.raises(InvalidInput, match="positions only"):
        absolute_pose_errors(associate(true, positions, EXACT), "rot_rad")
    with pytest.raises(InvalidInput, match="shorter than one stretch of 500 metres"):
        relative_pose_errors(associate(true, true, EXACT), stretch=Stretch(500, "metres"))
    for wrong in ({"delta": 0.0}, {"delta": 1.5, "unit": "frames"}):
        with pytest.raises(ValueError, match="delta"):
            Stretch(**wrong)  # type: ignore[arg-type]


def test_an_evaluation_tells_them_in_few_numbers() -> None:
    true = walk(20.0, 5.0)
    drift = np.outer(true.times_s - true.times_s[0], [0.01, 0.0, 0.0])
    pairs = associate(true, Trajectory(true.times_s, true.positions_m + drift, true.orientations_xyzw), EXACT)
    found = pose_errors_of(pairs)
    assert set(found.absolute) == {"trans", "rot_deg", "rot_rad", "full"}
    assert found.absolute["trans"].greatest == pytest.approx(drift[-1, 0])
    assert found.relative["seconds"]["trans"].mean == pytest.approx(0.01, rel=1e-3)
    assert found.relative["frames"]["trans"].mean == pytest.approx(0.01 / 5, rel=1e-3)
    assert found.relative["metres"]["rot_deg"].greatest < 1e-5
    short = pose_errors_of(pairs.first(2))
    assert set(short.relative) == {"frames"}
    positions = Trajectory(true.times_s, true.positions_m)
    alone = pose_errors_of(associate(true, positions, EXACT))
    assert set(alone.absolute) == {"trans"} and alone.relative == {}
