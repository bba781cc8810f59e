"""Refusals: each for its reason, with what was seen and what to do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from app.errors import NotLocated
from app.geometry.observations import TargetObservation
from app.photogrammetry.resection import Resection, ResectionOptions, resect
from app.photogrammetry.resection_judgement import JudgementOptions
from tests.photogrammetry.resection_scene import (
    Scene,
    calibrated,
    displaced,
    looking,
    map_of,
    observe,
    plate,
    room_scene,
)


def refusal_of(
    observations: Sequence[TargetObservation], scene: Scene, options: ResectionOptions | None = None
) -> NotLocated:
    with pytest.raises(NotLocated) as refusal:
        resect(observations, scene.target_map, scene.camera, options)
    assert refusal.value.fields["advice"] in refusal.value.detail
    assert isinstance(refusal.value.fields["seen"], dict)
    return refusal.value


def test_no_targets() -> None:
    assert refusal_of([], room_scene(2)).fields["reason"] == "no-targets"


def test_unknown_targets_are_listed() -> None:
    scene = room_scene(3)
    strangers = [replace(observation, code=observation.code + 500) for observation in observe(scene)]
    refusal = refusal_of(strangers, scene)
    assert refusal.fields["reason"] == "unknown-targets"
    assert refusal.fields["seen"]["codes"] == [501, 502, 503]


@pytest.mark.parametrize("cells", [(0, 3, 12), (0, 1, 2, 3), (0, 3, 5, 12, 15), (0, 1, 2, 3, 4)])
def test_too_few_dots(cells: tuple[int, ...]) -> None:
    scene = room_scene(1, 1)
    few = np.isin(np.arange(16), cells)
    observations = [replace(observation, measured=few) for observation in observe(scene)]
    assert refusal_of(observations, scene).fields["reason"] == "too-few-dots"


def redrawn(scene: Scene, seeds: range) -> tuple[list[Resection], list[NotLocated]]:
    """Poses and refusals of the same view under other noise."""
    found: list[Resection] = []
    refusals: list[NotLocated] = []
    for seed in seeds:
        try:
            found.append(resect(observe(scene, np.random.default_rng(seed)), scene.target_map, scene.camera))
        except NotLocated as refusal:
            refusals.append(refusal)
    return found, refusals


def test_a_far_plate_is_ambiguous_and_the_ratio_is_told() -> None:
    target = plate(5, [4.0, 9.0, 1.5], [0.5, -1.0, 0.0])
    scene = Scene(looking([4.0, 1.0, 1.5], [4.02, 9.0, 1.5]), map_of([target]), calibrated())
    _, refusals = redrawn(scene, range(10))
    assert len(refusals) >= 5
    for refusal in refusals:
        assert refusal.fields["reason"] == "ambiguous"
        assert 1.0 <= refusal.fields["seen"]["ambiguity_ratio"] < 2.0
        assert "two or more targets" in refusal.fields["advice"]


def test_a_frontal_far_plate_never_passes_far_off() -> None:
    target = plate(5, [4.0, 9.0, 1.5])
    scene = Scene(looking([4.0, 5.0, 1.5], [4.02, 9.0, 1.48]), map_of([target]), calibrated())
    found, refusals = redrawn(scene, range(20))
    assert len(refusals) >= 12
    assert {refusal.fields["reason"] for refusal in refusals} <= {"ambiguous", "too-few-dots"}
    for resection in found:
        assert np.linalg.norm(resection.site_from_cam.position_m - scene.site_from_cam.position_m) < 0.5


def test_two_targets_that_contradict_each_other_are_inconsistent() -> None:
    scene = room_scene(2, 5)
    first, second = scene.target_map.targets
    moved = displaced(first, np.array([0.1, 0.0, 0.1]), np.zeros(3))
    refusal = refusal_of(observe(scene), scene.with_targets([moved, second]))
    assert refusal.fields["reason"] == "inconsistent"
    assert refusal.fields["seen"]["codes"] == [1, 2]


def test_a_camera_of_another_zoom_is_inconsistent() -> None:
    scene = room_scene(8, 4)
    zoomed = scene.camera.camera.intrinsics * np.array([1.5, 1.5, *[1.0] * 7])
    stranger = replace(scene.camera, camera=scene.camera.camera.with_intrinsics(zoomed))
    with pytest.raises(NotLocated) as refusal:
        resect(observe(scene, np.random.default_rng(0)), scene.target_map, stranger)
    assert refusal.value.fields["reason"] == "inconsistent"


def test_a_position_far_outside_the_map_is_refused_and_the_limit_is_an_option() -> None:
    # Plates eight times as large: only so is a pose out there certain enough to be judged.
    near = [plate(code, [4.0 + code, 9.0, 1.5 + 0.3 * code], [0.3 * (code - 1), -1.0, 0.1]) for code in range(3)]
    grown = [
        replace(t, dots_m=t.site_from_target.position_m + 8.0 * (t.dots_m - t.site_from_target.position_m))
        for t in near
    ]
    scene = Scene(looking([5.0, -16.0, 1.5], [5.0, 9.0, 1.5]), map_of(grown), calibrated())
    observations = observe(scene, np.random.default_rng(1))
    refusal = refusal_of(observations, scene)
    assert refusal.fields["reason"] == "outside-site"
    assert refusal.fields["seen"]["outside_m"] == pytest.approx(24.5, abs=1.0)
    wider = ResectionOptions(judgement=JudgementOptions(max_outside_m=30.0))
    assert resect(observations, scene.target_map, scene.camera, wider).site_from_cam.position_m[1] < -15.0


def test_a_pose_that_is_hardly_known_is_refused() -> None:
    scene = room_scene(3, 2)
    strict = ResectionOptions(judgement=JudgementOptions(max_position_sigma_m=1e-4))
    refusal = refusal_of(observe(scene), scene, strict)
    assert refusal.fields["reason"] == "too-few-dots"
    assert refusal.fields["seen"]["position_sigma_m"] > 1e-4
