from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from app.errors import DegenerateGeometry, InvalidInput
from app.geometry.similarity import Similarity
from app.trajectories.alignment import Alignment, AlignmentOptions, align
from app.trajectories.association import AssociationOptions, Pairs, associate
from app.trajectories.trajectory import Trajectory
from tests.trajectories.walks import noisy, walk

NEAREST = AssociationOptions("nearest", max_gap_s=1e-6)


def paired(reference: Trajectory, estimate: Trajectory) -> Pairs:
    return associate(reference, estimate, NEAREST)


def moved(trajectory: Trajectory, similarity: Similarity) -> Trajectory:
    """The trajectory as a system with another frame tells it."""
    return Alignment("sim3", similarity.inverse(), 0).apply(trajectory)


rotations = st.tuples(*[st.floats(-3.0, 3.0)] * 3).map(lambda v: Rotation.from_rotvec(v).as_matrix())
shifts = st.tuples(*[st.floats(-50.0, 50.0)] * 3).map(np.array)
scales = st.floats(0.2, 5.0)


@given(rotations, shifts, scales, st.sampled_from(["positions", "orientations"]))
def test_what_was_done_to_a_trajectory_is_undone(
    rotation: np.ndarray, shift_m: np.ndarray, scale: float, source: str
) -> None:
    true = walk(20.0, 2.0)
    for kind, factor, turn in (
        ("se3", 1.0, rotation),
        ("sim3", scale, rotation),
        ("first_n", 1.0, rotation),
        ("origin", 1.0, rotation),
        ("posyaw", 1.0, Rotation.from_rotvec([0.0, 0.0, shift_m[0]]).as_matrix()),
        ("none", 1.0, np.eye(3)),
    ):
        pairs = paired(true, moved(true, Similarity(factor, turn, np.zeros(3) if kind == "none" else shift_m)))
        found = align(pairs, AlignmentOptions(kind, rotation_from=source))  # type: ignore[arg-type]
        back = found.apply(pairs.estimate)
        np.testing.assert_allclose(back.positions_m, true.positions_m, atol=1e-7)
        assert back.rotations is not None
        np.testing.assert_allclose(back.rotations, true.rotations, atol=1e-7)
        assert found.kind == kind


def test_the_fit_is_the_least_of_all_fits_nearby() -> None:
    true = walk(30.0, 2.0)
    pairs = paired(true, noisy(true, 0.3))

    def cost_m2(similarity: Similarity) -> float:
        return float(((similarity.apply(pairs.estimate.positions_m) - true.positions_m) ** 2).sum())

    random = np.random.default_rng(3)
    for kind, axes, scale_free in (("se3", (1, 1, 1), 0), ("posyaw", (0, 0, 1), 0), ("sim3", (1, 1, 1), 1)):
        best = align(pairs, AlignmentOptions(kind)).site_from_estimate  # type: ignore[arg-type]
        for _ in range(50):
            turn = Rotation.from_rotvec(random.normal(0, 0.01, 3) * axes).as_matrix()
            factor = 1.0 + scale_free * random.normal(0, 0.01)
            other = Similarity(
                best.scale * factor, turn @ best.rotation, best.translation_m + random.normal(0, 0.01, 3)
            )
            assert cost_m2(best) <= cost_m2(other)


def test_the_beginning_alone_fixes_first_n() -> None:
    true = walk(30.0, 2.0)
    astray = true.positions_m.copy()
    astray[10:] += 5.0
    found = align(paired(true, replace(true, positions_m=astray)), AlignmentOptions("first_n", first_n=10))
    assert found.pairs_used == 10
    np.testing.assert_allclose(found.site_from_estimate.translation_m, 0.0, atol=1e-9)


def test_covariances_turn_with_the_frame_and_lengths_grow_with_the_scale() -> None:
    covariance = np.diag([1.0, 4.0, 9.0, 16.0, 25.0, 36.0])
    trajectory = walk(1.0, 2.0, covariances=np.tile(covariance, (2, 1, 1)))
    quarter = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    turned = Alignment("sim3", Similarity(2.0, quarter, np.zeros(3)), 0).apply(trajectory).covariances
    assert turned is not None
    np.testing.assert_allclose(np.diag(turned[0]), [16.0, 4.0, 36.0, 25.0, 16.0, 36.0], atol=1e-12)
    flat = Trajectory(trajectory.times_s, trajectory.positions_m, None, np.tile(np.diag([1.0, 4.0, 9.0]), (2, 1, 1)))
    only_positions = Alignment("sim3", Similarity(2.0, quarter, np.zeros(3)), 0).apply(flat).covariances
    assert only_positions is not None
    np.testing.assert_allclose(np.diag(only_positions[0]), [16.0, 4.0, 36.0], atol=1e-12)


def on_a_line(orientations: bool) -> Trajectory:
    full = walk(10.0, 2.0)
    along_m = np.outer(np.arange(len(full)), [1.0, 0.0, 0.0])
    return Trajectory(full.times_s, along_m, full.orientations_xyzw if orientations else None)


def test_a_straight_walk_fixes_a_heading_and_with_orientations_a_rotation() -> None:
    line = on_a_line(orientations=True)
    with pytest.raises(DegenerateGeometry, match="posyaw"):
        align(paired(line, line), AlignmentOptions("se3"))
    np.testing.assert_allclose(
        align(paired(line, line), AlignmentOptions("posyaw")).site_from_estimate.rotation, np.eye(3), atol=1e-12
    )
    turn = Rotation.from_rotvec([0.3, -0.2, 0.9]).as_matrix()
    by_orientations = AlignmentOptions("se3", rotation_from="orientations")
    found = align(paired(line, moved(line, Similarity(1.0, turn, np.ones(3)))), by_orientations)
    np.testing.assert_allclose(found.site_from_estimate.rotation, turn, atol=1e-9)


def test_what_cannot_be_fixed_is_refused_with_a_way_out() -> None:
    two = walk(1.0, 2.0)
    with pytest.raises(DegenerateGeometry, match="align by origin"):
        align(paired(two, two), AlignmentOptions("se3"))
    standing = Trajectory(np.arange(5.0), np.tile([1.0, 2.0, 3.0], (5, 1)))
    with pytest.raises(DegenerateGeometry, match="no heading"):
        align(paired(standing, standing), AlignmentOptions("posyaw"))
    with pytest.raises(InvalidInput, match="reference has positions only"):
        align(paired(on_a_line(orientations=False), two.shifted(0)), AlignmentOptions("origin"))
    still = walk(5.0, 2.0)
    with pytest.raises(DegenerateGeometry, match="no scale"):
        align(
            paired(still, replace(still, positions_m=np.zeros_like(still.positions_m))),
            AlignmentOptions("sim3", rotation_from="orientations"),
        )
