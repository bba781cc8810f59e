"""From the camera to the antenna: the reference where the system under test measures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.errors import InvalidInput
from app.geometry.rotation import skew
from app.trajectories.trajectory import Array, Trajectory


def with_lever_arm(trajectory: Trajectory, lever_arm_m: Array) -> Trajectory:
    """The trajectory of a point that stands still in the camera's frame.

    Parameters
    ----------
    trajectory : Trajectory
        Of the camera.
    lever_arm_m : ndarray of shape (3,)
        The point in the camera's frame: x right, y down, z forward.

    Raises
    ------
    InvalidInput
        When the trajectory has no orientations.

    Notes
    -----
    ``p = p_cam + R l``; with ``R_true = Exp(dtheta) R`` its error is ``dp - [R l]_x dtheta``.
    """
    rotations = trajectory.rotations
    if rotations is None:
        raise InvalidInput("a lever arm takes a reference with orientations; leave lever_arm_m out")
    arm_m = rotations @ lever_arm_m
    if trajectory.covariances is None:
        return replace(trajectory, positions_m=trajectory.positions_m + arm_m)
    jacobian = np.broadcast_to(np.eye(6), (len(trajectory), 6, 6)).copy()
    jacobian[:, :3, 3:] = -skew(arm_m)
    covariances = jacobian @ trajectory.covariances @ jacobian.transpose(0, 2, 1)
    return replace(trajectory, positions_m=trajectory.positions_m + arm_m, covariances=covariances)
