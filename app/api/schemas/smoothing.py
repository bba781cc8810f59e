"""Trajectories between their snapshots."""

from __future__ import annotations

from pydantic import BaseModel, Field

from app.api.schemas.common import Quaternion, Vector3, time_of
from app.services.smoothing_work import SmoothedTrajectory


class SmoothedPose(BaseModel):
    """A pose at a moment that was asked for."""

    time: str
    position_m: Vector3
    orientation_xyzw: Quaternion
    covariance: list[list[float]] = Field(description="6 x 6: position (m, site axes), small rotation (rad, site axes)")
    position_sigma_m: Vector3


class SmoothedAnswer(BaseModel):
    """A trajectory at the moments that it tells of; the others lie in gaps or outside."""

    trajectory_id: str
    site_id: str
    poses: list[SmoothedPose]

    @classmethod
    def of(cls, smoothed: SmoothedTrajectory) -> SmoothedAnswer:
        """The answer for a smoothed trajectory."""
        trajectory, poses = smoothed.trajectory, smoothed.poses
        heading = {"trajectory_id": trajectory.trajectory_id, "site_id": trajectory.site_id}
        if not len(poses):
            return cls(**heading, poses=[])
        assert poses.orientations_xyzw is not None and poses.covariances is not None and poses.sigmas is not None
        columns = zip(
            poses.times_s.tolist(),
            poses.positions_m.tolist(),
            poses.orientations_xyzw.tolist(),
            poses.covariances.tolist(),
            poses.sigmas[:, :3].tolist(),
            strict=True,
        )
        told = [
            SmoothedPose(
                time=time_of(time_s),
                position_m=position_m,
                orientation_xyzw=orientation_xyzw,
                covariance=covariance,
                position_sigma_m=sigma_m,
            )
            for time_s, position_m, orientation_xyzw, covariance, sigma_m in columns
        ]
        return cls(**heading, poses=told)
