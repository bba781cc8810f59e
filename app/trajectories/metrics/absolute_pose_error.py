"""The absolute pose error of robotics (APE): each aligned pose against its partner."""

from __future__ import annotations

from typing import Literal

import numpy as np

from app.errors import InvalidInput
from app.geometry.rotation import log_rotation
from app.trajectories.association import Pairs
from app.trajectories.trajectory import Array, Trajectory

Part = Literal["trans", "rot_deg", "rot_rad", "full"]


def absolute_pose_errors(pairs: Pairs, part: Part = "trans") -> Array:
    """APE of each pair, shape (K,).

    Parameters
    ----------
    pairs : Pairs
        Aligned.
    part : {"trans", "rot_deg", "rot_rad", "full"}
        Distance of the positions (m); angle between the orientations; or ``|| E - I ||`` of ``E = Q^-1 P`` (unitless).

    Raises
    ------
    InvalidInput
        When orientations are needed and missing.

    Notes
    -----
    Sturm et al., IROS 2012, equation 2 with equation 3; parts as in the tool evo, which gives the same numbers.
    """
    reference, estimate = pairs.reference, pairs.estimate
    if part == "trans":
        return np.linalg.norm(estimate.positions_m - reference.positions_m, axis=1)
    between = relative_motion(matrices_of(pairs.reference), matrices_of(pairs.estimate))
    return error_of_motion(between, part)


def matrices_of(trajectory: Trajectory) -> Array:
    """Homogeneous matrices, shape (K, 4, 4), of site_from_cam.

    Raises
    ------
    InvalidInput
        When the trajectory has positions only.
    """
    rotations = trajectory.rotations
    if rotations is None:
        raise InvalidInput("one of the trajectories has positions only: ask for the part trans")
    matrices = np.broadcast_to(np.eye(4), (len(trajectory), 4, 4)).copy()
    matrices[:, :3, :3], matrices[:, :3, 3] = rotations, trajectory.positions_m
    return matrices


def relative_motion(first: Array, second: Array) -> Array:
    """``first^-1 second`` of rigid motions, shape (K, 4, 4)."""
    turned = first[:, :3, :3].transpose(0, 2, 1)
    motion = np.broadcast_to(np.eye(4), first.shape).copy()
    motion[:, :3, :3] = turned @ second[:, :3, :3]
    motion[:, :3, 3] = (turned @ (second[:, :3, 3] - first[:, :3, 3])[:, :, None])[:, :, 0]
    return motion


def error_of_motion(motion: Array, part: Part) -> Array:
    """One number per motion that should be the identity, shape (K,)."""
    if part == "trans":
        return np.linalg.norm(motion[:, :3, 3], axis=1)
    if part == "full":
        return np.linalg.norm(motion - np.eye(4), axis=(1, 2))
    angles_rad = np.linalg.norm(log_rotation(motion[:, :3, :3]), axis=1) if len(motion) else np.zeros(0)
    return angles_rad if part == "rot_rad" else np.degrees(angles_rad)
