"""The assumed datum: upright by the plates' planes, by their edges when all face one way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.geometry.rotation import exp_rotation
from app.geometry.similarity import Similarity
from app.photogrammetry.datum import assume_datum
from app.photogrammetry.network import Network
from tests.photogrammetry.survey_scene import build_room, ring_of_stations
from tests.photogrammetry.true_network import see

TURN = exp_rotation(np.array([0.7, -0.4, 0.9]))


def turned(network: Network) -> Network:
    """The network in the frame of some photograph."""
    return network.transformed(Similarity(1.0, TURN, np.array([1.0, 2.0, 3.0])))


def test_z_stands_upright_whatever_frame_the_network_came_in() -> None:
    network = see(build_room(), ring_of_stations(8)).network
    every = np.ones(len(network.target_rotations), dtype=np.bool_)
    assumed = assume_datum(turned(network), every)
    assert not assumed.from_edges
    up = assumed.site_from_model.rotation @ TURN @ [0.0, 0.0, 1.0]
    # Plates lean by 0.05 rad each.
    assert up[2] > np.cos(4.0 * 0.05 / np.sqrt(len(every)))
    placed = turned(network).transformed(assumed.site_from_model)
    np.testing.assert_allclose(placed.target_positions_m.mean(axis=0), 0.0, atol=1e-12)
    assert 0.0 < assumed.tilt_sigma_rad < 0.05


def test_plates_on_one_wall_stand_by_their_edges() -> None:
    network = see(build_room(), ring_of_stations(8)).network
    count = len(network.target_rotations)
    upright = np.tile(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]), (count, 1, 1))
    wall = turned(replace(network, target_rotations=upright))
    assumed = assume_datum(wall, np.ones(count, dtype=np.bool_))
    assert assumed.from_edges
    np.testing.assert_allclose(assumed.site_from_model.rotation @ TURN @ [0.0, 0.0, 1.0], [0.0, 0.0, 1.0], atol=1e-9)
