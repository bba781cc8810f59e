"""What speed costs a pose when the readout is not known: by how much a movement shifts what a still camera would tell.

The targets' rows are exposed before and after the middle of the picture. Where they lie evenly about it, little is
lost; where all lie at the top or the bottom, the pose is that of another moment.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import CalibratedCamera
from app.geometry.observations import TargetObservation
from app.geometry.pose import Pose
from app.geometry.readout import Readout
from app.geometry.target_map import TargetMap
from app.photogrammetry.kernels.lateness import sum_lateness
from app.photogrammetry.resection_equations import POSE_COUNT

Array = npt.NDArray[np.float64]

# Measured of phones: 31 to 35 ms, older ones up to 58 (Ringaby and Forssen, Efficient video rectification and
# stabilisation for cell-phones, International Journal of Computer Vision 96, 2012); newer sensors take 10 to 20.
TYPICAL_READOUT = Readout(0.03)


@dataclass(frozen=True)
class MotionCost:
    """Greatest shift of a position that is computed as if the camera had stood still.

    Attributes
    ----------
    readout_s : float
        That it was computed for.
    position_m_per_m_s, position_m_per_rad_s : float
        Per speed, and per angular speed, in the worst direction.
    """

    readout_s: float
    position_m_per_m_s: float
    position_m_per_rad_s: float


def motion_cost(
    site_from_cam: Pose,
    observations: Sequence[TargetObservation],
    target_map: TargetMap,
    camera: CalibratedCamera,
    readout: Readout = TYPICAL_READOUT,
) -> MotionCost:
    """The cost for a pose that was adjusted to the measured dots of these observations, each dot of one weight."""
    measured = np.concatenate([seen.measured for seen in observations])
    dots_m = np.concatenate([target_map.by_code[seen.code].dots_m for seen in observations])[measured]
    image_px = np.concatenate([seen.centres_px for seen in observations])[measured]
    times_s = readout.times_s(image_px, camera.camera.width_px, camera.camera.height_px)
    normals, late = np.empty((POSE_COUNT, POSE_COUNT)), np.empty((POSE_COUNT, POSE_COUNT))
    sum_lateness((*site_from_cam.arrays, camera.camera.intrinsics.copy()), dots_m, times_s, (normals, late))
    follows = np.linalg.lstsq(normals, late, rcond=None)[0][:3]
    by_speed, by_turn = (float(np.linalg.norm(part, ord=2)) for part in (follows[:, :3], follows[:, 3:]))
    return MotionCost(readout.duration_s, by_speed, by_turn)
