"""Panels to light: the picture that a perfect lens would cast, each pixel the mean light over its own area."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.geometry.camera import Camera
from app.geometry.pose import Pose
from app.planning.depth_order import PanelInView, panels_in_view
from app.planning.rays import RayGrid
from app.planning.scene import Gloss, Lamp, Panel, Scene
from app.planning.surfaces import Samples, box_coverage

Floats = npt.NDArray[np.float64]

SEAM_SAMPLES = 0.5
LEAST_LENGTH = 1e-9  # of the sum of two unit vectors: they may point against each other


@dataclass(frozen=True)
class PaintingOptions:
    """How finely pixels are sampled.

    Attributes
    ----------
    samples_per_detail : float
        Samples across a detail (a dot's radius). Edges are softened over one sample; with ten a dot's centroid errs by
        less than 0.01 sample.
    min_samples_per_pixel, max_samples_per_pixel : int
        Along each axis, where there is detail. Three keep a large dot's centroid within 0.004 px; the upper bound
        limits the work for plates too far away to be read.
    samples_at_once : int
        Bounds the memory: about 300 bytes each.
    """

    samples_per_detail: float = 10.0
    min_samples_per_pixel: int = 3
    max_samples_per_pixel: int = 6
    samples_at_once: int = 150_000


def paint(
    scene: Scene, camera: Camera, site_from_cam: Pose, options: PaintingOptions = PaintingOptions()
) -> npt.NDArray[np.float32]:
    """Light that falls on each pixel, shape (H, W, 3), RGB, linear, without blur, noise or vignetting.

    What no panel covers shows the ambient light.
    """
    rays = RayGrid(camera)
    picture = np.empty((camera.height_px, camera.width_px, 3), dtype=np.float32)
    picture[:] = scene.ambient_rgb
    for view in panels_in_view(scene.all_panels(), rays, site_from_cam):
        per_pixel = _samples_per_pixel(view, camera, options)
        lights = _Lights(scene, view.panel, site_from_cam.position_m)
        for columns, rows in _bands(view.box_px, per_pixel, options.samples_at_once):
            _paint_band(picture, view, rays, lights, (columns, rows, per_pixel))
    return picture


@dataclass(frozen=True)
class _Lights:
    """The scene's light as one panel receives it."""

    scene: Scene
    panel: Panel
    eye_m: Floats

    def returned(self, samples: Samples) -> Floats:
        """Light that the panel sends to the eye, shape (H, W, 3): from its print, of its own, and mirrored."""
        light = self.panel.surface.albedo(samples) * self.on(samples) + np.array(self.panel.glow_rgb)
        if self.panel.gloss is not None:
            for lamp in self.scene.lamps:
                light = light + self._mirrored(lamp, self.panel.gloss, samples)
        return np.asarray(light)

    def on(self, samples: Samples) -> Floats:
        """Light on the panel at its points, shape (H, W, 3)."""
        light = np.broadcast_to(np.array(self.scene.ambient_rgb), (*samples.x_m.shape, 3)).copy()
        for lamp in self.scene.lamps:
            light += self._of_lamp(lamp, samples)
        return light

    def _of_lamp(self, lamp: Lamp, samples: Samples) -> Floats:
        """Inverse square law and Lambert's cosine, at the lamp too when it is a lit sheet."""
        panel_from_site = self.panel.site_from_panel.inverse()
        x_m, y_m, z_m = panel_from_site.apply(lamp.position_m)
        distance2_m2 = (samples.x_m - x_m) ** 2 + (samples.y_m - y_m) ** 2 + z_m**2
        distance_m = np.sqrt(distance2_m2)
        strength = max(z_m, 0.0) / (distance2_m2 * distance_m)
        if lamp.facing is not None:
            along_x, along_y, along_z = panel_from_site.rotation @ lamp.facing
            ahead_m = along_x * (samples.x_m - x_m) + along_y * (samples.y_m - y_m) - along_z * z_m
            strength = strength * np.maximum(ahead_m, 0.0) / distance_m
        return np.asarray(strength[..., None] * np.array(lamp.intensity_rgb))

    def _mirrored(self, lamp: Lamp, gloss: Gloss, samples: Samples) -> Floats:
        """A normalised Blinn-Phong lobe, (n + 8) / 8 times that of a diffuse white of the same reflectance."""
        panel_from_site = self.panel.site_from_panel.inverse()
        ways_m = []
        for place_m in (lamp.position_m, self.eye_m):
            x_m, y_m, z_m = panel_from_site.apply(place_m)
            ways_m.append(np.stack([x_m - samples.x_m, y_m - samples.y_m, np.full(samples.x_m.shape, z_m)], axis=-1))
        to_lamp, to_eye = (way_m / np.linalg.norm(way_m, axis=-1, keepdims=True) for way_m in ways_m)
        half_way = to_lamp + to_eye
        cosine = np.maximum(half_way[..., 2], 0.0) / np.maximum(np.linalg.norm(half_way, axis=-1), LEAST_LENGTH)
        lobe = gloss.reflectance * (gloss.sharpness + 8.0) / 8.0 * cosine**gloss.sharpness
        return np.asarray(lobe[..., None] * self._of_lamp(lamp, samples))


def _samples_per_pixel(view: PanelInView, camera: Camera, options: PaintingOptions) -> int:
    """Along each axis, enough for the panel's detail at its distance and slant."""
    detail_m = view.panel.surface.detail_m
    if detail_m is None:
        return 1
    distance_m = float(np.linalg.norm(view.cam_from_panel.position_m))
    slant = abs(float(view.cam_from_panel.rotation[:, 2] @ view.cam_from_panel.position_m)) / distance_m
    detail_px = camera.fx_px * detail_m * slant / distance_m
    wanted = options.samples_per_detail / max(detail_px, np.finfo(np.float64).tiny)
    return int(np.clip(np.ceil(wanted), options.min_samples_per_pixel, options.max_samples_per_pixel))


def _bands(box_px: tuple[int, int, int, int], per_pixel: int, samples_at_once: int) -> Iterator[tuple[slice, slice]]:
    """The box cut into bands of rows that hold a bounded number of samples."""
    left, right, top, bottom = box_px
    rows = max(1, samples_at_once // ((right - left) * per_pixel**2))
    for first in range(top, bottom, rows):
        yield slice(left, right), slice(first, min(first + rows, bottom))


def _paint_band(
    picture: npt.NDArray[np.float32],
    view: PanelInView,
    rays: RayGrid,
    lights: _Lights,
    band: tuple[slice, slice, int],
) -> None:
    columns, rows, per_pixel = band
    samples = _samples(view, rays, _positions(columns, per_pixel), _positions(rows, per_pixel), per_pixel)
    panel = view.panel
    cover = panel_coverage(panel, samples)[..., None]
    if not cover.any():
        return
    light = cover * lights.returned(samples)
    behind = picture[rows, columns]
    picture[rows, columns] = behind * (1.0 - _pixel_means(cover, per_pixel)) + _pixel_means(light, per_pixel)


def panel_coverage(panel: Panel, samples: Samples) -> Floats:
    """Share of each sample that the panel covers, shape (H, W)."""
    # Walls and furniture meet at their edges, where two halves painted one over the other would leave a bright seam:
    # they reach half a sample further. Paper, which is measured, ends where it ends.
    reach = SEAM_SAMPLES if panel.surface.detail_m is None else 0.0
    return box_coverage(samples.x_m, samples.y_m, (panel.width_m, panel.height_m), samples.by_step_m, reach)


def _positions(pixels: slice, per_pixel: int) -> Floats:
    """Sample positions along one axis: the middles of equal parts of each pixel, pixel centres at integers."""
    count = (pixels.stop - pixels.start) * per_pixel
    return np.asarray(pixels.start - 0.5 + (np.arange(count) + 0.5) / per_pixel)


def _samples(view: PanelInView, rays: RayGrid, columns_px: Floats, rows_px: Floats, per_pixel: int) -> Samples:
    """Where the rays of a grid of image points meet the panel."""
    pose = view.cam_from_panel
    # (x, y, 1) of the panel is proportional to H (ray, 1); the factor is one over the depth along the ray.
    homography = np.linalg.inv(np.column_stack([pose.rotation[:, 0], pose.rotation[:, 1], pose.position_m]))
    ray_x, ray_y = rays.at(columns_px, rows_px)
    x, y, inverse_depth = (row[0] * ray_x + row[1] * ray_y + row[2] for row in homography)
    # Behind the horizon of the panel's plane there is nothing to meet: such samples are sent far outside.
    ahead = inverse_depth > 0
    depth_m = np.where(ahead, 1.0 / np.where(ahead, inverse_depth, 1.0), 1.0)
    outside_m = 2.0 * (view.panel.width_m + view.panel.height_m)
    x_m, y_m = np.where(ahead, x * depth_m, outside_m), np.where(ahead, y * depth_m, outside_m)
    # Distortion changes the step between rays by a few per cent; edges merely soften over that much more or less.
    step_x, step_y = 1.0 / (rays.camera.intrinsics[:2] * per_pixel)
    by_step_m = np.empty((*x_m.shape, 2, 2))
    for axis, point in enumerate((x_m, y_m)):
        by_step_m[..., axis, 0] = (homography[axis, 0] - point * homography[2, 0]) * depth_m * step_x
        by_step_m[..., axis, 1] = (homography[axis, 1] - point * homography[2, 1]) * depth_m * step_y
    return Samples(x_m, y_m, by_step_m)


def _pixel_means(samples: Floats, per_pixel: int) -> Floats:
    height, width = samples.shape[0] // per_pixel, samples.shape[1] // per_pixel
    return np.asarray(samples.reshape(height, per_pixel, width, per_pixel, -1).mean(axis=(1, 3)))
