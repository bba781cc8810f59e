"""The pose of a snapshot under the camera that explains it best, and what a movement did to it, or may have done."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.errors import NotLocated
from app.geometry.camera import CalibratedCamera
from app.geometry.observations import Detection
from app.geometry.target_map import TargetMap
from app.photogrammetry.resection import Resection
from app.photogrammetry.rolling_shutter.cost import TYPICAL_READOUT, motion_cost
from app.photogrammetry.rolling_shutter.resect import MovingResection, resect_moving
from app.storage.snapshots import RollingShutter


@dataclass(frozen=True)
class BestPose:
    """A pose and the camera that it was found with."""

    moving: MovingResection
    camera: CalibratedCamera

    @property
    def resection(self) -> Resection:
        """The pose."""
        return self.moving.resection


def resect_best(detection: Detection, target_map: TargetMap, cameras: tuple[CalibratedCamera, ...]) -> BestPose:
    """The pose under the camera that explains the picture best; the first refusal when none gives a pose.

    Raises
    ------
    NotLocated
    """
    found: list[BestPose] = []
    refusals: list[NotLocated] = []
    for camera in cameras:
        try:
            found.append(BestPose(resect_moving(detection.targets, target_map, camera), camera))
        except NotLocated as refusal:
            refusals.append(refusal)
    if not found:
        raise refusals[0]
    return min(found, key=lambda best: best.resection.sigma0)


def rolling_shutter_of(best: BestPose, target_map: TargetMap) -> RollingShutter:
    """What a movement did to a pose, or what it may have done where the readout is not known."""
    used = {target.code for target in best.resection.targets if target.used}
    seen = [target for target in best.moving.observations if target.code in used]
    readout, motion = best.camera.readout or TYPICAL_READOUT, best.moving.motion
    cost = motion_cost(best.resection.site_from_cam, seen, target_map, best.camera, readout)
    per_speed = (cost.position_m_per_m_s, cost.position_m_per_rad_s)
    if motion is None:
        return RollingShutter(best.camera.readout is not None, cost.readout_s, *per_speed)
    sigmas = np.sqrt(np.diag(motion.covariance))
    return RollingShutter(True, cost.readout_s, *per_speed, tuple(motion.values.tolist()), tuple(sigmas.tolist()))
