"""Photographs that several tests look at, rendered once."""

from __future__ import annotations

import numpy as np
import pytest

from app.planning.imaging import ImagingOptions
from app.planning.scene import Scene
from app.targets.family import CodeFamily, family_by_name
from tests.vision.scenes import Shot, before_wall, photograph, plates_in_rows

PX_PER_U = 4.0
GRID = (6, 4)
NOISE_SEEDS = (1, 2)


@pytest.fixture(scope="session")
def family() -> CodeFamily:
    return family_by_name("golay")


@pytest.fixture(scope="session")
def codes(family: CodeFamily) -> np.ndarray:
    """The family's codes in an order of no meaning."""
    return np.random.default_rng(0).permutation(family.codes)


@pytest.fixture(scope="session")
def plates_scene(codes: np.ndarray) -> Scene:
    """24 plates of 4 px per u, slanted by up to 55 degrees."""
    return before_wall(plates_in_rows(codes, GRID, PX_PER_U, seed=1))


@pytest.fixture(scope="session")
def plates_shot(plates_scene: Scene) -> Shot:
    """They as a phone's file shows them."""
    return photograph(plates_scene, ImagingOptions())
