"""What snapshots tell of their map: moved, vanished, new and turned targets, and silence about what is well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.geometry.target_map import TargetMap
from app.photogrammetry.map_watch import Finding, WatchedSnapshot, watch_map
from app.photogrammetry.places import places_of
from tests.photogrammetry.resection_scene import displaced
from tests.photogrammetry.watched_scene import CODES, MOVED, snapshot, snapshots, wall, with_displaced, without

GROSS_SIGMAS = 5.0


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(5)


@pytest.fixture
def believed(rng: np.random.Generator) -> TargetMap:
    return wall(rng)


def only(findings: tuple[Finding, ...]) -> Finding:
    (finding,) = findings
    return finding


def sigmas(finding: Finding, shift_m: np.ndarray) -> float:
    assert finding.displacement_m is not None and finding.covariance_m2 is not None
    error_m = finding.displacement_m - shift_m
    return float(np.sqrt(error_m @ np.linalg.solve(finding.covariance_m2, error_m)))


def test_nothing_is_told_of_a_room_as_it_was(believed: TargetMap, rng: np.random.Generator) -> None:
    assert watch_map(snapshots(believed, believed, rng, range(40)), believed) == ()


def test_no_snapshots_tell_nothing(believed: TargetMap) -> None:
    assert watch_map([], believed) == ()


@pytest.mark.parametrize("shift_mm", [5.0, 20.0, 400.0])
def test_a_moved_target_is_named_with_displacement_and_time(
    believed: TargetMap, rng: np.random.Generator, shift_mm: float
) -> None:
    shift_m = 1e-3 * shift_mm * np.array([0.8, 0.0, -0.6])
    calm = snapshots(believed, believed, rng, range(15))
    after = snapshots(believed, with_displaced(believed, MOVED, shift_m), rng, range(15, 27))
    finding = only(watch_map([*calm, *after], believed))
    assert (finding.kind, finding.code, finding.devices) == ("moved-target", MOVED, 1)
    assert sigmas(finding, shift_m) < GROSS_SIGMAS
    assert 14.0 <= finding.since_s <= 16.0
    assert finding.excess is not None and finding.excess > 1.0


def test_the_order_in_which_snapshots_come_is_no_matter(believed: TargetMap, rng: np.random.Generator) -> None:
    told = snapshots(believed, with_displaced(believed, MOVED, (0.01, 0.0, 0.0)), rng, range(10))
    there, back = only(watch_map(told, believed)), only(watch_map(told[::-1], believed))
    assert (there.since_s, there.excess) == (back.since_s, back.excess)


def test_two_moved_targets_are_told_apart(believed: TargetMap, rng: np.random.Generator) -> None:
    real = with_displaced(with_displaced(believed, 3, (0.015, 0.0, 0.0)), 9, (0.0, 0.0, 0.008))
    found = {finding.code: finding for finding in watch_map(snapshots(believed, real, rng, range(12)), believed)}
    assert set(found) == {3, 9}
    assert sigmas(found[3], np.array([0.015, 0.0, 0.0])) < GROSS_SIGMAS
    assert sigmas(found[9], np.array([0.0, 0.0, 0.008])) < GROSS_SIGMAS


def test_a_bad_snapshot_and_misread_codes_raise_nothing(believed: TargetMap, rng: np.random.Generator) -> None:
    elsewhere = with_displaced(believed, MOVED, (0.05, 0.0, 0.0))
    calm = snapshots(believed, believed, rng, range(12))
    bad = snapshots(believed, elsewhere, rng, (12, 13))
    misread = [snapshot(believed, without(believed, 2), rng, 14.0 + number, {7: 2}) for number in range(2)]
    assert watch_map([*calm, *bad, *misread], believed) == ()


def test_what_one_place_says_is_not_enough(believed: TargetMap, rng: np.random.Generator) -> None:
    real = with_displaced(believed, MOVED, (0.02, 0.0, 0.0))
    one = snapshot(believed, real, rng, 0.0)
    assert watch_map([replace(one, captured_s=float(time_s)) for time_s in range(50)], believed) == ()


def test_a_target_put_back_is_well_again(believed: TargetMap, rng: np.random.Generator) -> None:
    moved = snapshots(believed, with_displaced(believed, MOVED, (0.01, 0.0, 0.0)), rng, range(6))
    back = snapshots(believed, believed, rng, range(6, 30))
    assert watch_map([*moved, *back], believed) == ()


def test_a_target_turned_in_its_place_is_a_misfit(believed: TargetMap, rng: np.random.Generator) -> None:
    turned = tuple(
        displaced(target, np.zeros(3), np.array([0.0, 0.15, 0.0])) if target.code == MOVED else target
        for target in believed.targets
    )
    finding = only(watch_map(snapshots(believed, replace(believed, targets=turned), rng, range(12)), believed))
    assert (finding.kind, finding.code, finding.displacement_m) == ("misfit-target", MOVED, None)


def test_a_target_taken_down_is_missed_beside_its_neighbours(believed: TargetMap, rng: np.random.Generator) -> None:
    seen = snapshots(believed, believed, rng, range(5))
    bare = snapshots(believed, without(believed, MOVED), rng, range(5, 30))
    finding = only(watch_map([*seen, *bare], believed))
    assert (finding.kind, finding.code) == ("vanished-target", MOVED)
    assert finding.since_s >= 5.0
    assert watch_map([*seen, *bare, *snapshots(believed, believed, rng, (30, 31))], believed) == ()


def test_what_hides_its_neighbours_too_hides_a_target_without_alarm(
    believed: TargetMap, rng: np.random.Generator
) -> None:
    hidden = replace(believed, targets=tuple(target for target in believed.targets if target.code % 4 in (0, 1)))
    findings = watch_map(snapshots(believed, hidden, rng, range(25)), believed)
    assert {finding.code for finding in findings if finding.kind == "vanished-target"} <= {
        2,
        6,
        10,
    }  # next to those seen


def test_a_code_that_the_map_does_not_hold(believed: TargetMap, rng: np.random.Generator) -> None:
    smaller = without(believed, MOVED)
    finding = only(watch_map(snapshots(smaller, believed, rng, range(8)), smaller))
    assert (finding.kind, finding.code, finding.snapshots) == ("unknown-target", MOVED, finding.places)


def test_a_map_that_no_pose_agrees_with(believed: TargetMap, rng: np.random.Generator) -> None:
    calm = snapshots(believed, believed, rng, range(20))
    refused = [WatchedSnapshot(20.0 + number, None, None) for number in range(12)]
    finding = only(watch_map([*calm, *refused], believed))
    assert (finding.kind, finding.code, finding.snapshots) == ("map-misfit", None, 20)


def test_a_map_whose_residuals_have_risen(believed: TargetMap, rng: np.random.Generator) -> None:
    told = snapshots(believed, believed, rng, range(40))
    assert all(item.evidence is not None for item in told)
    risen = [
        replace(item, evidence=replace(item.evidence, sigma0=2.0)) if number >= 20 and item.evidence else item
        for number, item in enumerate(told)
    ]
    assert only(watch_map(risen, believed)).kind == "map-misfit"


def test_places_are_numbered_by_reach() -> None:
    positions_m = np.array([[0.0, 0, 0], [0.2, 0, 0], [1.0, 0, 0], [0.1, 0, 0], [1.2, 0, 0]])
    assert places_of(positions_m, 0.25).tolist() == [0, 0, 1, 0, 1]
    assert places_of(np.empty((0, 3)), 0.25).tolist() == []


def test_all_codes_of_the_wall_are_seen_somewhere(believed: TargetMap, rng: np.random.Generator) -> None:
    told = snapshots(believed, believed, rng, range(10))
    assert {code for item in told if item.evidence for code in item.evidence.seen_codes} == set(CODES)
