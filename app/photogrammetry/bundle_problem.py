"""What a bundle adjustment is given: sightings, cameras with priors, the plate, and what is known in advance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from app.geometry.camera import INTRINSIC_COUNT, CalibratedCamera, Camera
from app.photogrammetry.equations import PointEquations, PoseEquations
from app.photogrammetry.network import Network
from app.photogrammetry.prints import PRINT_COUNT, Prints
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
    prints : Prints
        In which batches the targets were printed.
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
    prints: Prints
    photo_poses: PoseEquations | None = None
    target_poses: PoseEquations | None = None
    points: PointEquations | None = None

    def __post_init__(self) -> None:
        if len(self.camera_of_photo) != self.sightings.photo_count or (np.diff(self.camera_of_photo) < 0).any():
            raise ValueError("each photograph needs a camera, and photographs are ordered by camera")
        if len(self.prints.batch) != self.sightings.target_count:
            raise ValueError("each target is of a print batch")

    @property
    def plane_m(self) -> Array:
        """Nominal dots in the target's plane, shape (16, 2)."""
        return dot_centres_u() * self.u_m

    @property
    def border_count(self) -> int:
        """Unknowns shared by many photographs: nine per camera, then the print scales of the batches."""
        return INTRINSIC_COUNT * len(self.cameras) + PRINT_COUNT * self.prints.count

    @property
    def free_border(self) -> Mask:
        """Which of the shared unknowns are adjusted: all, but the print scales that are held."""
        cameras = np.ones(INTRINSIC_COUNT * len(self.cameras), dtype=np.bool_)
        return np.concatenate([cameras, self.prints.free])

    def camera_columns(self, camera: int) -> slice:
        """Place of one camera's intrinsics among the shared unknowns."""
        return slice(INTRINSIC_COUNT * camera, INTRINSIC_COUNT * (camera + 1))

    def print_columns(self, batch: int | None = None) -> slice:
        """Place of one batch's print scale, or of all batches', among the shared unknowns."""
        first = INTRINSIC_COUNT * len(self.cameras)
        if batch is None:
            return slice(first, self.border_count)
        return slice(first + PRINT_COUNT * batch, first + PRINT_COUNT * (batch + 1))

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
