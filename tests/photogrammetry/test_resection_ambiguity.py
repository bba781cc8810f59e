"""The mirror image: where it stands, when it is told from the truth, and when it is not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.geometry.pose import Pose
from app.geometry.rotation import angle_between_deg, exp_rotation
from app.photogrammetry.resection_adjustment import adjust_pose
from app.photogrammetry.resection_ambiguity import AmbiguityOptions, better_side, look_for_mirror, mirrored_pose
from app.photogrammetry.resection_consensus import Problem
from app.photogrammetry.resection_equations import CameraPrior, State
from app.photogrammetry.resection_input import sight_targets
from tests.photogrammetry.resection_scene import Scene, calibrated, looking, map_of, observe, plate, room_scene

OPTIONS = AmbiguityOptions()
ONE = np.ones(1, dtype=np.bool_)


def single(distance_m: float, tilt_rad: float) -> Scene:
    """One plate, looked at from a distance, tilted to the side."""
    normal = [np.sin(tilt_rad), -np.cos(tilt_rad), 0.1]
    target = plate(5, [4.0, 7.0, 1.5], normal, 0.2)
    return Scene(looking([4.0, 7.0 - distance_m, 1.5], [4.02, 7.0, 1.48]), map_of([target]), calibrated())


def problem_of(scene: Scene, seed: int = 0) -> Problem:
    return Problem(
        sight_targets(observe(scene, np.random.default_rng(seed)), scene.target_map), CameraPrior.of(scene.camera)
    )


def truth(scene: Scene) -> State:
    return State(scene.site_from_cam, np.zeros(9))


@given(turn=st.tuples(*[st.floats(-0.8, 0.8)] * 3), distance_m=st.floats(1.0, 8.0))
@settings(max_examples=40, deadline=None)
def test_mirroring_reflects_the_normal_about_the_line_of_sight_and_is_its_own_inverse(
    turn: tuple[float, float, float], distance_m: float
) -> None:
    cam_from_site = Pose(exp_rotation(np.array(turn)) @ np.diag([1.0, -1.0, -1.0]), np.array([0.1, -0.2, distance_m]))
    site_from_cam = cam_from_site.inverse()
    plate_in_site = np.zeros(3), np.array([0.0, 0.0, 1.0])  # a plate whose frame is the site's
    mirrored = mirrored_pose(site_from_cam, *plate_in_site)
    sight = cam_from_site.position_m / np.linalg.norm(cam_from_site.position_m)
    normal, other = cam_from_site.rotation[:, 2], mirrored.inverse().rotation[:, 2]
    np.testing.assert_allclose(other, 2.0 * (normal @ sight) * sight - normal, atol=1e-7)
    np.testing.assert_allclose(mirrored.inverse().position_m, cam_from_site.position_m, atol=1e-9)
    again = mirrored_pose(mirrored, *plate_in_site)
    np.testing.assert_allclose(again.rotation, site_from_cam.rotation, atol=1e-6)


def test_a_near_plate_from_the_side_is_told_from_its_mirror_image() -> None:
    scene = single(1.0, 0.6)
    problem = problem_of(scene)
    ambiguity = look_for_mirror(problem, ONE, problem.adjust(ONE, truth(scene)), OPTIONS)
    assert not ambiguity.is_open(OPTIONS)
    assert ambiguity.ratio is not None and ambiguity.ratio > 5.0
    assert angle_between_deg(ambiguity.adjusted.state.site_from_cam.rotation, scene.site_from_cam.rotation) < 1.0


def test_a_far_small_plate_leaves_the_question_open() -> None:
    scene = single(8.0, 0.5)
    found = []
    for seed in range(8):
        problem = problem_of(scene, seed)
        found.append(look_for_mirror(problem, ONE, problem.adjust(ONE, truth(scene)), OPTIONS))
    assert sum(ambiguity.is_open(OPTIONS) for ambiguity in found) >= 6
    for ambiguity in found:
        assert ambiguity.ratio is not None and ambiguity.ratio >= 1.0


def test_the_better_pose_wins_from_either_side() -> None:
    scene = single(1.5, 0.5)
    problem = problem_of(scene, 1)
    plane = problem.sighted.centres_m[0], problem.sighted.rotations[0, :, 2]
    wrong = State(mirrored_pose(scene.site_from_cam, *plane), np.zeros(9))
    right = better_side(problem, ONE, wrong, OPTIONS)
    assert angle_between_deg(right.site_from_cam.rotation, scene.site_from_cam.rotation) < 2.0
    adjusted = adjust_pose(problem.sighted, problem.prior, wrong, free_camera=False)
    assert look_for_mirror(problem, ONE, adjusted, OPTIONS).adjusted.chi2 < adjusted.chi2


def test_targets_in_space_have_no_mirror_image() -> None:
    scene = room_scene(8, 3)
    problem = problem_of(scene)
    everyone = np.ones(8, dtype=np.bool_)
    ambiguity = look_for_mirror(problem, everyone, problem.adjust(everyone, truth(scene)), OPTIONS)
    assert ambiguity.other is None
    assert ambiguity.ratio is None
    assert ambiguity.log_odds == float("inf")


def test_two_small_plates_side_by_side_far_away_are_still_one_plane() -> None:
    # A second plate in the same plane 0.2 m aside is not a second view: the mirror image must still be asked about.
    normal = [0.5, -1.0, 0.0]
    pair = [plate(1, [4.0, 8.0, 1.5], normal), plate(2, [4.18, 8.09, 1.5], normal)]
    scene = Scene(looking([4.0, 1.5, 1.5], [4.1, 8.0, 1.5]), map_of(pair), calibrated())
    problem = problem_of(scene, 2)
    both = np.ones(2, dtype=np.bool_)
    ambiguity = look_for_mirror(problem, both, problem.adjust(both, truth(scene)), AmbiguityOptions(mirror_limit=1.0))
    assert ambiguity.other is not None
    assert ambiguity.ratio == pytest.approx(np.sqrt(ambiguity.other.attainable_chi2 / ambiguity.adjusted.chi2))
