"""Which targets a camera sees, where their dots fall, and which dots something hides: the truth about a photograph."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import Camera
from app.geometry.pose import Pose
from app.planning.depth_order import NEAREST_M
from app.planning.scene import Panel, PostedTarget, Scene
from app.targets.layout import DOT_RADIUS_U

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

RIM_POINTS = 8  # per dot, besides its centre, to tell whether anything hides a part of it
TOUCHING_M = 1e-6  # a panel this near to a dot carries it rather than hides it
HALF_PIXEL = 0.5  # pixel centres are integers: the frame ends half a pixel beyond the outermost


@dataclass(frozen=True)
class SeenTarget:
    """The truth about one target in one photograph.

    Attributes
    ----------
    code : int
    dots_px : ndarray of shape (16, 2)
        Images of the dots' centres, row-major cells, pixel centres at integers.
    hidden : ndarray of shape (16,), bool
        Dots of which something hides a part, or that reach out of the frame.
    px_per_u : float
        fx u / mean depth, not foreshortened.
    incidence_deg : float
        Between the line of sight and the plate's normal, at the plate's centre.
    wrong : bool
        A plate of wrong structure.
    """

    code: int
    dots_px: Floats
    hidden: npt.NDArray[np.bool_]
    px_per_u: float
    incidence_deg: float
    wrong: bool

    @property
    def whole(self) -> bool:
        """Whether all sixteen dots are seen wholly."""
        return not self.hidden.any()


def see(scene: Scene, camera: Camera, site_from_cam: Pose) -> tuple[SeenTarget, ...]:
    """Targets of a scene of which a camera sees at least one dot wholly, in the scene's order."""
    screens = _Screens.of_panels(scene.all_panels())
    seen = []
    for index, target in enumerate(scene.targets):
        others = screens.without(len(scene.panels) + index)
        one = _see_one(target, others, camera, site_from_cam)
        if one is not None:
            seen.append(one)
    return tuple(seen)


@dataclass(frozen=True)
class _Screens:
    """Panels as arrays: what may stand between an eye and a point."""

    rotations: Floats  # (P, 3, 3), site_from_panel
    centres_m: Floats  # (P, 3)
    halves_m: Floats  # (P, 2)

    @classmethod
    def of_panels(cls, panels: tuple[Panel, ...]) -> _Screens:
        return cls(
            np.stack([panel.site_from_panel.rotation for panel in panels]),
            np.stack([panel.site_from_panel.position_m for panel in panels]),
            np.array([[panel.width_m, panel.height_m] for panel in panels]) / 2,
        )

    def without(self, index: int) -> _Screens:
        rest = np.arange(len(self.rotations)) != index
        return _Screens(self.rotations[rest], self.centres_m[rest], self.halves_m[rest])

    def hide(self, points_m: Floats, eye_m: Floats) -> Flags:
        """Which points, shape (N, 3), the eye does not see, shape (N,)."""
        eye = np.einsum("pji,pj->pi", self.rotations, eye_m - self.centres_m)
        fronts = eye[:, 2] > 0  # a panel is there from its front alone
        rotations, halves_m, eye = self.rotations[fronts], self.halves_m[fronts], eye[fronts]
        points = np.einsum("pji,pnj->pni", rotations, points_m - self.centres_m[fronts, None])
        beyond = points[..., 2] < -TOUCHING_M
        share = eye[:, None, 2] / (eye[:, None, 2] - np.where(beyond, points[..., 2], -1.0))
        crossing_m = eye[:, None, :2] + share[..., None] * (points[..., :2] - eye[:, None, :2])
        within = (np.abs(crossing_m) <= halves_m[:, None]).all(axis=-1)
        return np.asarray((beyond & within).any(axis=0))


def _see_one(target: PostedTarget, others: _Screens, camera: Camera, site_from_cam: Pose) -> SeenTarget | None:
    cam_from_site = site_from_cam.inverse()
    cam_from_target = cam_from_site.compose(target.site_from_target)
    towards_m = -cam_from_target.position_m
    cosine = float(cam_from_target.rotation[:, 2] @ towards_m / np.linalg.norm(towards_m))
    points_m = _points_of_dots(target)
    points_cam_m = cam_from_site.apply(points_m)
    if cosine <= 0 or points_cam_m[..., 2].min() < NEAREST_M:
        return None
    hidden = _outside(points_cam_m, camera)
    if not hidden.all():
        points_hidden = others.hide(points_m.reshape(-1, 3), site_from_cam.position_m)
        hidden |= points_hidden.reshape(points_m.shape[:2]).any(axis=1)
    if hidden.all():
        return None
    dots_cam_m = points_cam_m[:, 0]
    px_per_u = camera.fx_px * target.u_m / float(dots_cam_m[:, 2].mean())
    incidence_deg = float(np.degrees(np.arccos(min(cosine, 1.0))))
    return SeenTarget(target.code, camera.project(dots_cam_m), hidden, px_per_u, incidence_deg, target.wrong)


def _points_of_dots(target: PostedTarget) -> Floats:
    """Centre and rim of each dot in the site frame, shape (16, 1 + RIM_POINTS, 3)."""
    angle = np.arange(RIM_POINTS) * 2.0 * np.pi / RIM_POINTS
    rim = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(RIM_POINTS)]) * DOT_RADIUS_U * target.u_m
    offsets_m = np.vstack([np.zeros(3), rim * [*target.print_scale_xy, 1.0]]) @ target.site_from_target.rotation.T
    return np.asarray(target.dots_m()[:, None] + offsets_m)


def _outside(points_cam_m: Floats, camera: Camera) -> Flags:
    """Dots that reach out of the frame, shape (16,)."""
    # Far outside the frame a lens polynomial may fold back into it: the straight ray decides first.
    fx, fy, cx, cy = camera.intrinsics[:4]
    straight_px = points_cam_m[..., :2] / points_cam_m[..., 2:] * [fx, fy] + [cx, cy]
    size_px = np.array([camera.width_px, camera.height_px])
    far = (np.abs(straight_px - size_px / 2) > size_px).any(axis=-1)
    points_px = camera.project(points_cam_m)
    beyond = ((points_px < -HALF_PIXEL) | (points_px > size_px - HALF_PIXEL)).any(axis=-1)
    return np.asarray((far | beyond).any(axis=1))
