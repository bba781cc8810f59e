"""Which panels are in view, and in which order they hide each other: the painter's order."""

from __future__ import annotations

from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter

import numpy as np
import numpy.typing as npt

from app.geometry.pose import Pose
from app.planning.rays import RayGrid
from app.planning.scene import Panel

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

NEAREST_M = 0.02  # nearer than that nothing is drawn: no lens focuses there
COPLANAR_M = 1e-6  # panels nearer to one plane than that lie on it
TOUCHING = 1e-6  # of the focal length: what two panels share by less is an edge
EQUAL = 1e-4  # of the distance: a sheet that cuts its wall by less lies on it
EDGE_POINTS = 12  # per edge of a clipped outline: distortion bends edges, outermost points may lie in between


@dataclass(frozen=True)
class PanelInView:
    """A panel some of which may fall into the picture.

    Attributes
    ----------
    panel : Panel
    cam_from_panel : Pose
    outline_cam_m : ndarray of shape (N, 3)
        Corners of what the frame holds of it, in the camera's frame.
    box_px : tuple of int
        First and one past the last column, first and one past the last row.
    """

    panel: Panel
    cam_from_panel: Pose
    outline_cam_m: Floats
    box_px: tuple[int, int, int, int]


def panels_in_view(panels: tuple[Panel, ...], rays: RayGrid, site_from_cam: Pose) -> list[PanelInView]:
    """Panels that turn their front to the camera and reach into its frame, the hidden before the hiding ones."""
    cam_from_site = site_from_cam.inverse()
    seen = []
    for panel in panels:
        cam_from_panel = cam_from_site.compose(panel.site_from_panel)
        facing = cam_from_panel.rotation[:, 2] @ cam_from_panel.position_m < 0
        if not facing:
            continue
        outline_m = _in_frame(cam_from_site.apply(panel.corners_m()), rays)
        box_px = _box_px(outline_m, rays) if len(outline_m) else None
        if box_px is not None:
            seen.append(PanelInView(panel, cam_from_panel, outline_m, box_px))
    return [seen[index] for index in _painters_order(seen)]


def _in_frame(corners_cam_m: Floats, rays: RayGrid) -> Floats:
    """Corners of the part of a panel that the frame holds, shape (N, 3); none when it lies outside."""
    (left, top), (right, bottom) = rays.least, rays.greatest
    outline_m = corners_cam_m
    # Half-spaces n . p >= d: in front of the camera, and between the rays of the frame's four sides.
    for normal, offset_m in (
        ((0.0, 0.0, 1.0), NEAREST_M),
        ((1.0, 0.0, -left), 0.0),
        ((-1.0, 0.0, right), 0.0),
        ((0.0, 1.0, -top), 0.0),
        ((0.0, -1.0, bottom), 0.0),
    ):
        outline_m = _clip(outline_m, np.array(normal), offset_m)
        if len(outline_m) == 0:
            break
    return outline_m


def _box_px(outline_m: Floats, rays: RayGrid) -> tuple[int, int, int, int] | None:
    """Pixels that an outline encloses, or None when they are none."""
    share = np.arange(EDGE_POINTS)[:, None, None] / EDGE_POINTS
    edges_m = outline_m + share * (np.roll(outline_m, -1, axis=0) - outline_m)
    points_px = rays.camera.project(edges_m.reshape(-1, 3))
    size_px = np.array([rays.camera.width_px, rays.camera.height_px])
    first = np.clip(np.floor(points_px.min(axis=0)).astype(int) - 1, 0, size_px)
    last = np.clip(np.ceil(points_px.max(axis=0)).astype(int) + 2, 0, size_px)
    if (first >= last).any():
        return None
    return int(first[0]), int(last[0]), int(first[1]), int(last[1])


def _clip(polygon_m: Floats, normal: Floats, offset_m: float) -> Floats:
    """The part of a convex polygon, shape (N, 3), with ``normal . p >= offset_m`` (Sutherland and Hodgman)."""
    inside = polygon_m @ normal - offset_m
    if (inside >= 0).all():
        return polygon_m
    kept = []
    for here, there, at_here, at_there in zip(
        polygon_m, np.roll(polygon_m, -1, axis=0), inside, np.roll(inside, -1), strict=True
    ):
        if at_here >= 0:
            kept.append(here)
        if (at_here >= 0) != (at_there >= 0):
            kept.append(here + at_here / (at_here - at_there) * (there - here))
    return np.array(kept).reshape(-1, 3)


def _painters_order(seen: list[PanelInView]) -> list[int]:
    """Indices so that no panel is painted over by one behind it; listed order where nothing decides.

    Raises
    ------
    graphlib.CycleError
        When panels hide each other in a ring: cut one of them in two.
    """
    if not seen:
        return []
    overlap = _boxes_overlap(np.array([view.box_px for view in seen]))
    nearer, undecided = _nearer_by_planes(seen)
    nearer &= overlap
    for one, other in np.argwhere(undecided & overlap):
        ahead = _is_nearer(seen[one], seen[other])
        nearer[one, other], nearer[other, one] = ahead is True, ahead is False
    try:
        return _sorted(nearer)
    except CycleError:
        # Boxes overlap where panels merely lie beside each other; when that closes a ring, their outlines decide.
        for one, other in np.argwhere(nearer):
            nearer[one, other] = len(_shared_m(seen[one], seen[other])) > 0
        return _sorted(nearer)


def _nearer_by_planes(seen: list[PanelInView]) -> tuple[Flags, Flags]:
    """Which panel is nearer than which where both are seen, and the pairs whose planes cut each other's panel."""
    corners_cam_m = np.stack([view.cam_from_panel.apply(_corners_panel_m(view.panel)) for view in seen])
    normals = np.stack([view.cam_from_panel.rotation[:, 2] for view in seen])
    offsets_m = np.stack([view.cam_from_panel.position_m for view in seen])
    # heights[i, j, k]: corner k of panel i above the plane of panel j; above is where the camera is.
    heights_m = np.einsum("ikc,jc->ijk", corners_cam_m, normals) - (normals * offsets_m).sum(axis=1)[None, :, None]
    above, below = (heights_m >= -COPLANAR_M).all(axis=2), (heights_m <= COPLANAR_M).all(axis=2)
    coplanar, cutting = above & below, ~above & ~below
    later = np.arange(len(seen))[:, None] > np.arange(len(seen))
    nearer = later & coplanar | ~coplanar & ((above & ~above.T) | (below.T & ~below))
    return nearer, cutting & cutting.T & later


def _sorted(nearer: Flags) -> list[int]:
    """Indices, each after those that it is nearer than."""
    graph = {index: np.flatnonzero(row).tolist() for index, row in enumerate(nearer)}
    return list(TopologicalSorter(graph).static_order())


def _is_nearer(one: PanelInView, other: PanelInView) -> bool | None:
    """Whether a panel is nearer in the middle of what it shares with another; of equals it is; None for nothing."""
    shared_m = _shared_m(one, other)
    if len(shared_m) == 0:
        return None
    middle_m, pose = shared_m.mean(axis=0), other.cam_from_panel
    return bool(pose.rotation[:, 2] @ pose.position_m / (pose.rotation[:, 2] @ middle_m) > 1.0 - EQUAL)


def _shared_m(one: PanelInView, other: PanelInView) -> Floats:
    """The part of a panel that lies in one line of sight with another, shape (N, 3); an edge is none."""
    shared_m, outline_m = one.outline_cam_m, other.outline_cam_m
    inside_m = outline_m.mean(axis=0)
    for here, there in zip(outline_m, np.roll(outline_m, -1, axis=0), strict=True):
        side = np.cross(here, there)
        shared_m = _clip(shared_m, side * np.sign(side @ inside_m), 0.0)
        if len(shared_m) == 0:
            return shared_m
    picture = shared_m[:, :2] / shared_m[:, 2:]
    spread = np.linalg.svd(picture - picture.mean(axis=0), compute_uv=False)[-1]
    return shared_m if spread > TOUCHING else shared_m[:0]


def _corners_panel_m(panel: Panel) -> Floats:
    half = np.array([panel.width_m, panel.height_m]) / 2
    return np.column_stack([np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]]) * half, np.zeros(4)])


def _boxes_overlap(boxes_px: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
    left, right, top, bottom = boxes_px.T
    across = (left[:, None] < right) & (left < right[:, None])
    down = (top[:, None] < bottom) & (top < bottom[:, None])
    return np.asarray(across & down)
