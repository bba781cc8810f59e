"""How far a picture moves while it is exposed, when the camera does."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.geometry.camera import Camera
from app.geometry.pose import Pose
from app.planning.scene import Panel, Scene

Floats = npt.NDArray[np.float64]

NOTHING_AHEAD_M = 100.0  # where no panel is met the picture moves as that of something far away


def motion_px(scene: Scene, camera: Camera, during: tuple[Pose, Pose, Pose]) -> tuple[float, float]:
    """Movement of the picture's middle along columns and rows.

    One movement stands for the whole picture: that of what the middle shows, at its own distance.

    Parameters
    ----------
    scene : Scene
    camera : Camera
    during : tuple of Pose
        ``site_from_cam`` at the begin, the middle and the end of the exposure.
    """
    begin, middle, end = during
    target_m = middle.apply(np.array([0.0, 0.0, distance_ahead_m(scene, middle)]))
    columns, rows = camera.project(end.inverse().apply(target_m)) - camera.project(begin.inverse().apply(target_m))
    return float(columns), float(rows)


def distance_ahead_m(scene: Scene, site_from_cam: Pose) -> float:
    """To the first panel that the optical axis meets from its front."""
    ahead = site_from_cam.rotation[:, 2]
    distances_m = [_distance_m(panel, site_from_cam.position_m, ahead) for panel in scene.panels]
    return min((one for one in distances_m if one is not None), default=NOTHING_AHEAD_M)


def _distance_m(panel: Panel, eye_m: Floats, ahead: Floats) -> float | None:
    panel_from_site = panel.site_from_panel.inverse()
    eye, way = panel_from_site.apply(eye_m), panel_from_site.rotation @ ahead
    if eye[2] <= 0 or way[2] >= 0:
        return None
    distance_m = float(-eye[2] / way[2])
    met = np.abs(eye[:2] + distance_m * way[:2])
    return distance_m if (met <= [panel.width_m / 2, panel.height_m / 2]).all() else None
