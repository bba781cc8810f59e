"""The truth of a synthetic survey in the adjustment's own terms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import CalibratedCamera
from app.geometry.pose import Pose
from app.photogrammetry.bundle_problem import BundleProblem
from app.photogrammetry.free_adjustment import held_photo
from app.photogrammetry.network import Network
from app.photogrammetry.prints import PRINT_SIGMA, one_batch
from app.photogrammetry.sightings import Sightings, gather_sightings
from tests.photogrammetry.survey_scene import CAMERA, NOISE_PX, U_M, Room, build_room, photograph, ring_of_stations

# What a careful user knows of a camera in advance: loose enough to move, tight enough to make any network regular.
PRIOR = CalibratedCamera(CAMERA, np.diag(np.square([20.0, 20.0, 10.0, 10.0, 0.05, 0.1, 0.001, 0.001, 0.1])), "exif")


@dataclass(frozen=True)
class Truth:
    """Where everything that is seen stands, and what is seen, weighted by 0.1 px."""

    network: Network
    sightings: Sightings
    codes: npt.NDArray[np.intp]

    @property
    def problem(self) -> BundleProblem:
        """The free adjustment, held at the first photograph."""
        one_camera = np.zeros(self.sightings.photo_count, dtype=np.intp)
        prints = one_batch(len(self.codes), PRINT_SIGMA, held=True)
        return BundleProblem(self.sightings, one_camera, (PRIOR,), U_M, prints, photo_poses=held_photo(self.network, 0))


def see(room: Room, stations: Sequence[Pose], noise_px: float = 0.0, seed: int = 3) -> Truth:
    """A survey of a room, targets by code."""
    rng = np.random.default_rng(seed)
    sightings, codes = gather_sightings([photograph(room, station, rng, noise_px=noise_px) for station in stations])
    poses = [room.poses[int(code)] for code in codes]
    network = Network(
        np.array([station.rotation for station in stations]),
        np.array([station.position_m for station in stations]),
        np.array([pose.rotation for pose in poses]),
        np.array([pose.position_m for pose in poses]),
        CAMERA.intrinsics[None].copy(),
        np.ones((len(poses), 2)),
    )
    stated = sightings.reweighted(NOISE_PX / 0.01) if noise_px == 0.0 else sightings  # exact dots come with 0.01 px
    return Truth(network, stated, codes)


def small_truth() -> Truth:
    """Three photographs of a dozen targets, for derivatives."""
    return see(build_room(5), ring_of_stations(3))
