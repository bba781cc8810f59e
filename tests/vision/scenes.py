"""Plates that float before a grey wall, seen by a camera at the site's origin: photographs whose truth is known."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.geometry.camera import Camera
from app.geometry.observations import Detection, TargetObservation
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.planning.imaging import ImagingOptions, digitise, expose
from app.planning.painting import paint
from app.planning.photo_file import encode_jpeg
from app.planning.scene import Panel, PostedTarget, Scene
from app.planning.sight import SeenTarget, see
from app.planning.surfaces import PlainSurface
from app.planning.survey_plan import phone_camera
from app.planning.synthetic import identity_of
from app.vision.homography import PLATE_DOTS_U, fit_homographies
from app.vision.photo import load_photo

U_M = 0.02
AT_ORIGIN = Pose(np.eye(3), np.zeros(3))
TOWARDS_CAMERA = np.diag([1.0, -1.0, -1.0])
SMALL_CAMERA = phone_camera(640, 480)
WALL_RGB = (150, 152, 148)
NOISELESS = ImagingOptions(full_well_electrons=0.0, vignetting=0.0, contrast=0.0, lens_sigma_px=0.7)


@dataclass(frozen=True)
class Shot:
    """A photograph with its truth."""

    bgr: npt.NDArray[np.uint8]
    truth: tuple[SeenTarget, ...]

    def whole_codes(self) -> set[int]:
        return {target.code for target in self.truth if target.whole and not target.wrong}

    def dots_px(self, code: int) -> npt.NDArray[np.float64]:
        return next(target.dots_px for target in self.truth if target.code == code)


def plate_at(
    place_px: tuple[float, float],
    px_per_u: float,
    code: int = 389,
    turn_rad: tuple[float, float, float] = (0.0, 0.0, 0.0),
    camera: Camera = SMALL_CAMERA,
) -> PostedTarget:
    """A plate whose centre is seen at a place; it faces the camera but for rotations about x, y and its own normal."""
    ray = np.append(camera.normalise(np.array(place_px)), 1.0)
    depth_m = camera.fx_px * U_M / px_per_u
    away_rad = np.arctan(np.hypot(*ray[:2]))
    to_sight = exp_rotation(away_rad * np.array([-ray[1], ray[0], 0.0]) / max(np.hypot(*ray[:2]), 1e-12))
    slant, roll = exp_rotation(np.array([*turn_rad[:2], 0.0])), exp_rotation(np.array([0.0, 0.0, turn_rad[2]]))
    return PostedTarget(code, Pose(to_sight @ slant @ TOWARDS_CAMERA @ roll, depth_m * ray), U_M)


def facing_panel(position_m: npt.NDArray[np.float64], size_m: tuple[float, float], rgb: tuple[int, int, int]) -> Panel:
    return Panel(Pose(TOWARDS_CAMERA, position_m), *size_m, PlainSurface(rgb))


def before_wall(targets: Iterable[PostedTarget], *panels: Panel) -> Scene:
    """The plates, panels that may hide them, and a wall behind all of them."""
    targets = tuple(targets)
    far_m = 1.3 * max((target.site_from_target.position_m[2] for target in targets), default=1.0)
    wall = facing_panel(np.array([0.0, 0.0, far_m]), (6.0 * far_m, 6.0 * far_m), WALL_RGB)
    return Scene(targets, (wall, *panels))


def plates_in_rows(
    codes: npt.NDArray[np.int64], grid: tuple[int, int], px_per_u: float, seed: int, slant_deg: float = 55.0
) -> tuple[PostedTarget, ...]:
    """Columns x rows of plates that fill a small frame, turned at random: any roll, and slants up to a limit."""
    rng = np.random.default_rng(seed)
    columns, rows = grid
    targets = []
    for index, code in enumerate(codes[: columns * rows].tolist()):
        row, column = divmod(index, columns)
        place_px = ((column + 0.5) * SMALL_CAMERA.width_px / columns, (row + 0.5) * SMALL_CAMERA.height_px / rows)
        slant_rad, towards_rad = np.radians(slant_deg) * rng.random(), 2.0 * np.pi * rng.random()
        turn_rad = (slant_rad * np.cos(towards_rad), slant_rad * np.sin(towards_rad), 2.0 * np.pi * rng.random())
        targets.append(plate_at(place_px, px_per_u, code, turn_rad))
    return tuple(targets)


def photographs(
    scene: Scene, imagings: Iterable[ImagingOptions], seed: int = 1, camera: Camera = SMALL_CAMERA
) -> list[Shot]:
    """One view under several settings, each written to a file and read again; painted once."""
    light, truth = paint(scene, camera, AT_ORIGIN), see(scene, camera, AT_ORIGIN)
    shots = []
    for imaging in imagings:
        rgb = digitise(expose(light, imaging), imaging, np.random.default_rng(seed))
        jpeg = encode_jpeg(rgb, imaging, identity_of(camera, imaging))
        shots.append(Shot(load_photo(jpeg).bgr, truth))
    return shots


def photograph(scene: Scene, imaging: ImagingOptions, seed: int = 1, camera: Camera = SMALL_CAMERA) -> Shot:
    return photographs(scene, [imaging], seed, camera)[0]


def sensor_shots(
    scene: Scene, imaging: ImagingOptions, seeds: Iterable[int], camera: Camera = SMALL_CAMERA
) -> list[Shot]:
    """What the sensor gives before any file is written, once for each seed of the noise."""
    sensor = expose(paint(scene, camera, AT_ORIGIN), imaging)
    truth = see(scene, camera, AT_ORIGIN)
    pictures = (digitise(sensor, imaging, np.random.default_rng(seed)) for seed in seeds)
    return [Shot(np.ascontiguousarray(rgb[..., ::-1]), truth) for rgb in pictures]


def wrong_plate(target: PostedTarget, cells_rgb: npt.NDArray[np.uint8]) -> PostedTarget:
    return replace(target, wrong_cells_rgb=cells_rgb)


def found(detection: Detection) -> dict[int, TargetObservation]:
    return {target.code: target for target in detection.targets}


def refused(detection: Detection) -> list[str]:
    return [rejected.reason for rejected in detection.rejected]


def measured_errors(detection: Detection, shot: Shot) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Errors, shape (N, 2), px, of all measured dots, and their covariances, shape (N, 2, 2)."""
    errors_px = [t.centres_px[t.measured] - shot.dots_px(t.code)[t.measured] for t in detection.targets]
    covariances_px2 = [target.covariances_px2[target.measured] for target in detection.targets]
    return np.concatenate(errors_px), np.concatenate(covariances_px2)


def true_homographies(shot: Shot) -> npt.NDArray[np.float64]:
    """Image from plate, shape (P, 3, 3), of all targets in view, through their true dots."""
    dots_px = np.stack([target.dots_px for target in shot.truth])
    return fit_homographies(PLATE_DOTS_U, dots_px, np.ones(dots_px.shape[:2]))
