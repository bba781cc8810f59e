"""Pulls of an adjusted network cancel, respond to a moved target as is said, and scatter as is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.geometry.pose import Pose
from app.photogrammetry.bundle import BundleOptions, adjust_bundle
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.network import POSE_COUNT, Network
from app.photogrammetry.target_pulls import PullOptions, TargetPulls, target_pulls
from tests.photogrammetry.survey_scene import NOISE_PX, build_room, ring_of_stations
from tests.photogrammetry.true_network import see

ROOM, STATIONS = build_room(), ring_of_stations(24)
MOVED, STEP_M = 2, np.array([1e-4, -2e-4, 1e-4])  # as small as a linear law takes it
LOSS, OPTIONS = BundleOptions().loss, PullOptions()


def pulls_after(problem: BundleProblem, network: Network, options: PullOptions = OPTIONS) -> tuple[TargetPulls, ...]:
    pulled = target_pulls(problem, adjust_bundle(problem, network).network, LOSS, options)
    pulls = tuple(pulled)
    assert len(pulled) == len(pulls) > 0
    return pulls


def test_pulls_of_a_target_cancel() -> None:
    truth = see(ROOM, STATIONS, noise_px=NOISE_PX)
    for one in pulls_after(truth.problem, truth.network):
        np.testing.assert_allclose(one.pulls.sum(axis=0), 0.0, atol=1e-3 * np.abs(one.pulls).max())


def test_pulls_respond_to_a_target_that_some_photographs_show_elsewhere() -> None:
    truth = see(ROOM, STATIONS)
    code = int(truth.codes[MOVED])
    moved_from = ROOM.poses[code]
    later = see(ROOM.with_pose(code, Pose(moved_from.rotation, moved_from.position_m + STEP_M)), STATIONS)
    rows = np.flatnonzero(truth.sightings.target == MOVED)
    changed = rows[len(rows) // 2 :]
    dots_px = truth.sightings.dots_px.copy()
    dots_px[changed] = later.sightings.dots_px[changed]
    pulls = pulls_after(truth.problem.with_sightings(replace(truth.sightings, dots_px=dots_px)), truth.network)
    one = next(one for one in pulls if one.target == MOVED)
    steps = np.zeros((len(rows), POSE_COUNT))
    steps[np.isin(one.rows, changed), :3] = STEP_M
    # Residuals are computed less observed: the target seen a step farther pulls back by the information.
    expected = -np.tensordot(one.information, steps, axes=2)
    np.testing.assert_allclose(one.pulls, expected, atol=0.02 * np.abs(expected).max())


@pytest.mark.parametrize("most", [24, 6])
def test_contradictions_are_as_great_as_chance_has_them(most: int) -> None:
    truth = see(ROOM, STATIONS, noise_px=NOISE_PX)
    pulls = pulls_after(truth.problem, truth.network, PullOptions(most=most))
    share = np.array([one.squares / one.freedom for one in pulls])
    # The median is 1 by their scale; chi-squares of n freedoms over n scatter by sqrt(2 / n).
    scatter = np.sqrt(2.0 / np.mean([one.freedom for one in pulls]))
    assert share.mean() == pytest.approx(1.0, abs=4.0 * scatter / np.sqrt(len(share)) + 0.05)


def test_of_many_sightings_some_are_looked_at_and_say_the_same() -> None:
    truth = see(ROOM, STATIONS, noise_px=NOISE_PX)
    every, some = (pulls_after(truth.problem, truth.network, PullOptions(most=most)) for most in (24, 6))
    assert max(len(one.rows) for one in every) > 6
    for whole, part in zip(every, some, strict=True):
        assert len(part.rows) == min(len(whole.rows), 6)
        assert set(part.rows) <= set(whole.rows) and {whole.rows[0], whole.rows[-1]} <= set(part.rows)
        assert part.freedom == 6 * min(len(part.rows), len(whole.rows) - 1)
        assert part.information.shape == (len(part.rows), 6, len(part.rows), 6)
        if len(part.rows) == len(whole.rows):
            # They differ by the variance that all targets tell, no more.
            np.testing.assert_allclose(part.pulls, whole.pulls, rtol=0.5, atol=0.1 * np.abs(whole.pulls).max())
