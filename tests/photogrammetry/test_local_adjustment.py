"""The neighbourhood of fresh photographs is adjusted; what is not of it, the cameras and the print scales stay."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.geometry.rotation import exp_rotation
from app.photogrammetry.growth import Growth, GrowthOptions
from app.photogrammetry.initial_network import grow_networks
from app.photogrammetry.local_adjustment import adjust_locally
from app.photogrammetry.network import NetworkStep
from app.photogrammetry.survey_input import read_survey
from tests.photogrammetry.survey_scene import PLATE, build_room, ring_of_stations, survey_photos

LEAN_RAD = 0.02
OFF_M = 0.02
# Photographs of 0.1 px see a dozen targets at some metres: a fifth of a milliradian.
ORIENTED_RAD = 1e-3


def grown() -> Growth:
    survey = read_survey(survey_photos(build_room(), ring_of_stations(16)), PLATE)
    (network,) = grow_networks(survey.problem, GrowthOptions(), [].append)
    return network


def leaning(growth: Growth, photos: np.ndarray) -> Growth:
    """The growth with some photographs off."""
    network = growth.network
    step = NetworkStep(
        np.zeros((len(network.photo_positions_m), 6)),
        np.zeros((len(network.target_positions_m), 6)),
        np.zeros_like(network.intrinsics),
        np.zeros_like(network.print_scale),
    )
    step.photos[photos] = np.array([OFF_M, -OFF_M, OFF_M, LEAN_RAD, LEAN_RAD, -LEAN_RAD])
    return replace(growth, network=network.moved(step))


def test_a_leaning_photograph_is_put_upright_among_its_neighbours() -> None:
    growth, fresh = grown(), np.array([3, 4])
    mended = adjust_locally(leaning(growth, fresh), fresh)
    turns = mended.network.photo_rotations[fresh] @ np.swapaxes(growth.network.photo_rotations[fresh], -1, -2)
    assert np.linalg.norm(turns - np.eye(3), axis=(1, 2)).max() < ORIENTED_RAD
    assert mended.oriented.all()


def test_cameras_and_print_scales_stay() -> None:
    growth, fresh = grown(), np.array([3, 4])
    mended = adjust_locally(leaning(growth, fresh), fresh)
    np.testing.assert_allclose(mended.network.intrinsics, growth.network.intrinsics, rtol=1e-3, atol=1e-3)
    np.testing.assert_array_equal(mended.network.print_scale, growth.network.print_scale)
    assert mended.adjusted_photos == growth.adjusted_photos


def test_without_photographs_around_it_nothing_is_held_and_nothing_done() -> None:
    growth = grown()
    assert adjust_locally(growth, np.flatnonzero(growth.oriented)) is growth


def test_a_turn_of_the_whole_frame_turns_the_result() -> None:
    """The frame is arbitrary: what is adjusted in a turned one is the same network turned."""
    growth, fresh = grown(), np.array([5])
    off = leaning(growth, fresh)
    turn = exp_rotation(np.array([0.3, -0.2, 0.5]))
    turned_network = replace(
        off.network,
        photo_rotations=turn @ off.network.photo_rotations,
        photo_positions_m=off.network.photo_positions_m @ turn.T,
        target_rotations=turn @ off.network.target_rotations,
        target_positions_m=off.network.target_positions_m @ turn.T,
    )
    straight = adjust_locally(off, fresh).network.photo_positions_m
    turned = adjust_locally(replace(off, network=turned_network), fresh).network.photo_positions_m
    np.testing.assert_allclose(turned @ turn, straight, atol=1e-5)
