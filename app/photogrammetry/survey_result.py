"""What a survey publishes: the target map, the cameras, the photographs' poses, the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import CalibratedCamera, CameraIdentity
from app.geometry.pose import Pose
from app.geometry.target_map import MappedTarget, TargetMap
from app.photogrammetry.report import AdjustmentReport
from app.photogrammetry.survey_solution import Solution

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


@dataclass(frozen=True)
class SurveyCamera:
    """A camera of the survey with its calibration."""

    identity: CameraIdentity
    calibrated: CalibratedCamera


@dataclass(frozen=True)
class AdjustedPhoto:
    """An oriented photograph.

    Attributes
    ----------
    name, camera_key : str
    site_from_cam : Pose
    covariance : ndarray of shape (6, 6)
        Position (m), small rotation (rad), site axes, datum included.
    rms_px : float
        Root mean square residual per coordinate.
    codes : tuple of int
        Of the targets that took part, ascending.
    """

    name: str
    camera_key: str
    site_from_cam: Pose
    covariance: Array
    rms_px: float
    codes: tuple[int, ...]

    @property
    def target_count(self) -> int:
        """How many targets took part."""
        return len(self.codes)


@dataclass(frozen=True)
class SurveyResult:
    """All that an adjustment yields; ``unoriented`` holds a name and a reason per photograph without a pose."""

    target_map: TargetMap
    cameras: tuple[SurveyCamera, ...]
    photos: tuple[AdjustedPhoto, ...]
    unoriented: tuple[tuple[str, str], ...]
    report: AdjustmentReport


def mapped_targets(solution: Solution, codes: Index) -> tuple[MappedTarget, ...]:
    """The published targets; codes of shape (T,)."""
    dots_m = solution.network.dots_m(solution.problem.u_m)
    rays = solution.problem.sightings.rays()
    return tuple(
        MappedTarget(
            int(codes[target]),
            solution.network.target_pose(int(target)),
            dots_m[target],
            solution.parted.targets[target],
            int(rays[target]),
            float(solution.target_rms_px[target]),
        )
        for target in np.flatnonzero(solution.published)
    )


def adjusted_photos(
    solution: Solution, names: Sequence[str], identities: Sequence[CameraIdentity], codes: Index
) -> tuple[AdjustedPhoto, ...]:
    """The oriented photographs, named; codes of shape (T,)."""
    sightings = solution.problem.sightings
    starts = np.searchsorted(sightings.photo, np.arange(1, len(names)))  # sightings are ordered by photograph
    codes_of_photo = np.split(codes[sightings.target], starts)
    return tuple(
        AdjustedPhoto(
            name,
            identities[solution.problem.camera_of_photo[photo]].key,
            solution.network.photo_pose(photo),
            solution.photo_covariances[photo],
            float(solution.photo_rms_px[photo]),
            tuple(sorted(codes_of_photo[photo].tolist())),
        )
        for photo, name in enumerate(names)
    )
