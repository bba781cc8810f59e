"""What a bundle adjustment is given: sightings, cameras with priors, the plate, and what is known in advance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera, Camera
from app.photogrammetry.equations import PointEquations, PoseEquations
from app.photogrammetry.network import PRINT_COUNT, Network
from app.photogrammetry.sightings import Sightings
from app.targets.layout import dot_centres_u

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]
Mask = npt.NDArray[np.bool_]

CHUNK_SIGHTINGS = 512  # sightings linearised at once: 5 MB of derivatives, which stay in the processor's cache


@dataclass(frozen=True)
class BundleProblem:
    """All observations of one adjustment.

    Attributes
    ----------
    sightings : Sightings
    camera_of_photo : ndarray of shape (P,)
        Ascending, so that the sightings of one camera stand together.
    cameras : tuple of CalibratedCamera
        What is known of the C cameras in advance.
    u_m : float
        Nominal module of the plates.
    print_sigma : float or None
        Standard deviation of each print scale about 1; None holds the print as it is.
    photo_poses : PoseEquations or None
        Known poses of photographs: the one that holds a free network.
    target_poses : PoseEquations or None
        Known poses of targets: a map that this survey extends.
    points : PointEquations or None
        Control points.
    """

    sightings: Sightings
    camera_of_photo: Index
    cameras: tuple[CalibratedCamera, ...]
    u_m: float
    print_sigma: float | None = None
    photo_poses: PoseEquations | None = None
    target_poses: PoseEquations | None = None
    points: PointEquations | None = None

    def __post_init__(self) -> None:
        if len(self.camera_of_photo) != self.sightings.photo_count or (np.diff(self.camera_of_photo) < 0).any():
            raise ValueError("each photograph needs a camera, and photographs are ordered by camera")

    @property
    def plane_m(self) -> Array:
        """Nominal dots in the target's plane, shape (16, 2)."""
        return dot_centres_u() * self.u_m

    @property
    def border_count(self) -> int:
        """Unknowns shared by many photographs: nine per camera, then the print scale."""
        return INTRINSIC_COUNT * len(self.cameras) + PRINT_COUNT

    @property
    def free_border(self) -> Mask:
        """Which of the shared unknowns are adjusted: all, but the print scale when it is held."""
        free = np.ones(self.border_count, dtype=np.bool_)
        free[-PRINT_COUNT:] = self.print_sigma is not None
        return free

    def camera_columns(self, camera: int) -> slice:
        """Place of one camera's intrinsics among the shared unknowns."""
        return slice(INTRINSIC_COUNT * camera, INTRINSIC_COUNT * (camera + 1))

    def chunks(self) -> Iterator[tuple[int, slice]]:
        """Runs of sightings of one camera, short enough for the processor's cache: camera, slice."""
        camera = self.camera_of_photo[self.sightings.photo]
        borders = np.searchsorted(camera, np.arange(len(self.cameras) + 1))
        for index, (first, end) in enumerate(pairwise(borders)):
            for start in range(first, end, CHUNK_SIGHTINGS):
                yield index, slice(start, min(start + CHUNK_SIGHTINGS, end))

    def camera_at(self, network: Network, camera: int) -> Camera:
        """One camera with the network's present intrinsics."""
        return self.cameras[camera].camera.with_intrinsics(network.intrinsics[camera])

    def with_sightings(self, sightings: Sightings) -> BundleProblem:
        """The same problem with other observations of the same photographs and targets."""
        return replace(self, sightings=sightings)
