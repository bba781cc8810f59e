"""Plates seen by an ideal camera of focal length 1,000 px, as homographies: what the algebra's laws are tried on."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from hypothesis import strategies as st

from app.geometry.rotation import exp_rotation

FOCAL_PX = 1000.0
PRINCIPAL_PX = np.array([960.0, 540.0])

slants_rad = st.floats(0.0, np.radians(65.0))
turns_rad = st.floats(0.0, 2.0 * np.pi)
distances_u = st.floats(26.0, 600.0)  # from twice the plate's width to where a dot is 1.7 px in radius
# Seen from so far that an affinity is nearly all there is of the perspective.
NEARLY_AFFINE = {
    "slant_rad": st.floats(0.0, np.radians(50.0)),
    "towards_rad": turns_rad,
    "roll_rad": turns_rad,
    "distance_u": st.floats(150.0, 500.0),
}
views = st.builds(
    lambda slant, towards, roll, distance, aside: image_from_plate(slant, towards, roll, distance, aside),
    slants_rad,
    turns_rad,
    turns_rad,
    distances_u,
    st.tuples(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4)),
)


def image_from_plate(
    slant_rad: float, towards_rad: float, roll_rad: float, distance_u: float, aside: tuple[float, float] = (0.0, 0.0)
) -> npt.NDArray[np.float64]:
    """Homography, shape (3, 3), of a plate whose normal makes the angle ``slant`` with the line of sight."""
    ray = np.array([*aside, 1.0])
    away_rad = np.arctan(np.hypot(*aside))
    to_sight = exp_rotation(away_rad * np.array([-aside[1], aside[0], 0.0]) / max(np.hypot(*aside), 1e-12))
    slant = exp_rotation(slant_rad * np.array([np.cos(towards_rad), np.sin(towards_rad), 0.0]))
    roll = exp_rotation(np.array([0.0, 0.0, roll_rad]))
    # Plate coordinates have y down, as the camera has: facing each other, the axes agree.
    cam_from_plate = to_sight @ slant @ roll
    centre = distance_u * ray / np.linalg.norm(ray)
    camera = np.array([[FOCAL_PX, 0.0, PRINCIPAL_PX[0]], [0.0, FOCAL_PX, PRINCIPAL_PX[1]], [0.0, 0.0, 1.0]])
    image = camera @ np.column_stack([cam_from_plate[:, 0], cam_from_plate[:, 1], centre])
    return image / image[2, 2]
