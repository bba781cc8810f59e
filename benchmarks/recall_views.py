"""Photographs for the recall matrix: plates at random places and slants before a wall, under one hard condition."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import cv2
import numpy as np
import numpy.typing as npt

from app.geometry.camera import Camera
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.planning.imaging import ImagingOptions, digitise, expose
from app.planning.painting import paint
from app.planning.photo_file import encode_jpeg
from app.planning.pillar import bent_dots_m, bent_panels
from app.planning.scene import Gloss, Lamp, Panel, Scene
from app.planning.shadow import ShadowedSurface
from app.planning.surfaces import PictureSurface, PlainSurface, PlateSurface
from app.planning.survey_plan import phone_camera
from app.planning.synthetic import identity_of
from app.planning.tone import linear_of_srgb
from app.targets.layout import BASE_CELLS, DEFAULT_U_M, PLATE_SIDE_U, dots_target_m
from app.vision.photo import load_photo

Floats = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]

AT_ORIGIN = Pose(np.eye(3), np.zeros(3))
TOWARDS_CAMERA = np.diag([1.0, -1.0, -1.0])
U_M = DEFAULT_U_M
SHEET_U = PLATE_SIDE_U + 2.0  # plate and a margin of 1 u
SHEET_M = SHEET_U * U_M
DIAGONAL_U = np.sqrt(2.0) * SHEET_U + 1.0  # no sheet reaches over another, however it is turned
MEDIUM_CAMERA = phone_camera(960, 720)
WALL_RGB = (188, 186, 178)
WALL_BEYOND = 1.4  # of the farthest plate's depth: slanted plates stay before it
WALL_TEXTURE_PX = 1024
WALL_SHAPES = 500
COVER_M_OFF = 0.2 * U_M  # a note stuck on, a board held against it
COVERS_RGB = ((120, 120, 120), (92, 62, 46), (214, 206, 190), (40, 60, 110), (180, 150, 120))
EVEN_LIGHT, DIM_LIGHT = 1.0, 0.04


@dataclass(frozen=True)
class Condition:
    """What makes the plates of a photograph hard to read, or not.

    Attributes
    ----------
    px_per_u : float
        Size of the plates, fx u / mean depth; up to a twentieth more.
    incidence_deg : tuple of float
        Range of the angles between line of sight and normal.
    family : str
        Of the codes.
    camera : Camera
    imaging : ImagingOptions
    lamp_off_u : float or None
        A lamp before each plate's edge, so far off the paper, gives most of the light: a gradient across the plate.
    shadow_share : float or None
        A shadow's edge across each plate leaves this share of the light.
    glare : Gloss or None
        The sheets are laminated with this film, and each mirrors a lamp towards the camera.
    pillar_u : float or None
        Radius of the pillar that each plate is bent round.
    hidden_share : float
        Part of each plate's side that a board covers, from any of the four sides.
    hidden_base_dot : bool
        Whether one of the base dots of each plate is covered.
    at_border : bool
        Whether the plates stand along the frame's border and touch it.
    window : bool
        Whether a bright window is in the picture.
    plates_max : int
        In one photograph.
    """

    px_per_u: float = 4.0
    incidence_deg: tuple[float, float] = (0.0, 45.0)
    family: str = "golay"
    camera: Camera = MEDIUM_CAMERA
    imaging: ImagingOptions = field(default_factory=ImagingOptions)
    lamp_off_u: float | None = None
    shadow_share: float | None = None
    glare: Gloss | None = None
    pillar_u: float | None = None
    hidden_share: float = 0.0
    hidden_base_dot: bool = False
    at_border: bool = False
    window: bool = False
    plates_max: int = 20


@dataclass(frozen=True)
class PlateTruth:
    """A plate in view: what it says and where its dots are, shape (16, 2), px."""

    code: int
    dots_px: Floats


@dataclass(frozen=True)
class HardPhoto:
    """A photograph, written to a file and read again, and the truth about it."""

    bgr: Pixels
    plates: tuple[PlateTruth, ...]


def hard_photo(condition: Condition, codes: npt.NDArray[np.int64], seed: int) -> HardPhoto:
    """Take the photograph; the same arguments give the same pixels."""
    rng = np.random.default_rng(seed)
    camera = condition.camera
    poses = _poses(condition, rng)
    chosen = rng.choice(codes, len(poses), replace=False)
    lamps, panels, plates = [], [_wall(poses, camera, rng)], []
    if condition.window:
        panels.append(_window(poses, camera, rng))
    for code, pose in zip(chosen.tolist(), poses, strict=True):
        panels += _sheet(code, pose, condition, rng)
        lamps += _lamps(pose, condition, rng)
        plates.append(PlateTruth(code, camera.project(_dots_m(pose, condition))))
    ambient = DIM_LIGHT if condition.lamp_off_u is not None else EVEN_LIGHT
    scene = Scene((), tuple(panels), tuple(lamps), (ambient, ambient, ambient))
    rgb = digitise(expose(paint(scene, camera, AT_ORIGIN), condition.imaging), condition.imaging, rng)
    jpeg = encode_jpeg(rgb, condition.imaging, identity_of(camera, condition.imaging))
    return HardPhoto(load_photo(jpeg).bgr, tuple(plates))


def _dots_m(pose: Pose, condition: Condition) -> Floats:
    if condition.pillar_u is None:
        return pose.apply(dots_target_m(U_M))
    return bent_dots_m(pose, U_M, condition.pillar_u * U_M)


def _poses(condition: Condition, rng: np.random.Generator) -> list[Pose]:
    """Plates on a grid wide enough for any turn, some of its cells taken."""
    camera, size_px = condition.camera, DIAGONAL_U * condition.px_per_u
    columns, rows = (max(int(side_px // size_px), 1) for side_px in (camera.width_px, camera.height_px))
    cells = [(column, row) for column in range(columns) for row in range(rows)]
    if condition.at_border:
        cells = [(column, row) for column, row in cells if column in (0, columns - 1)]
    cells = [cells[index] for index in rng.permutation(len(cells))[: condition.plates_max]]
    places = [np.array([(column + 0.5) / columns, (row + 0.5) / rows]) for column, row in cells]
    poses = [_pose(place * [camera.width_px, camera.height_px], condition, rng) for place in places]
    return [_against_border(pose, condition) for pose in poses] if condition.at_border else poses


def _pose(place_px: Floats, condition: Condition, rng: np.random.Generator) -> Pose:
    """Facing the camera, then slanted towards any side, then rolled by any angle."""
    ray = np.append(condition.camera.normalise(place_px), 1.0)
    depth_m = condition.camera.fx_px * U_M / (condition.px_per_u * rng.uniform(1.0, 1.05))
    away_rad, across = np.arctan(np.hypot(*ray[:2])), np.array([-ray[1], ray[0], 0.0])
    to_sight = exp_rotation(away_rad * across / max(np.linalg.norm(across), 1e-12))
    slant_rad, towards_rad = np.radians(rng.uniform(*condition.incidence_deg)), rng.uniform(0.0, 2.0 * np.pi)
    slant = exp_rotation(slant_rad * np.array([np.cos(towards_rad), np.sin(towards_rad), 0.0]))
    roll = exp_rotation(np.array([0.0, 0.0, rng.uniform(0.0, 2.0 * np.pi)]))
    return Pose(to_sight @ slant @ TOWARDS_CAMERA @ roll, depth_m * ray)


def _against_border(pose: Pose, condition: Condition) -> Pose:
    """The plate shifted to the left or right end of the frame: its outermost dot ends a quarter of a dot inside."""
    camera, moved = condition.camera, pose
    for _ in range(4):  # the lens bends lines, but it converges at once
        dots_px = camera.project(moved.apply(dots_target_m(U_M)))[:, 0]
        inside_px = 1.25 * condition.px_per_u
        right = moved.position_m[0] > 0.0
        short_px = camera.width_px - 1.0 - inside_px - dots_px.max() if right else inside_px - dots_px.min()
        step_m = short_px * moved.position_m[2] / camera.fx_px
        moved = Pose(moved.rotation, moved.position_m + np.array([step_m, 0.0, 0.0]))
    return moved


def _wall(poses: list[Pose], camera: Camera, rng: np.random.Generator) -> Panel:
    """Plaster with pictures of all colours, far enough behind."""
    far_m = WALL_BEYOND * max(float(pose.position_m[2]) for pose in poses)
    picture = np.full((WALL_TEXTURE_PX, WALL_TEXTURE_PX, 3), WALL_RGB, dtype=np.uint8)
    for _ in range(WALL_SHAPES):
        colour, centre = rng.integers(0, 256, 3).tolist(), rng.integers(0, WALL_TEXTURE_PX, 2).tolist()
        radius = int(rng.integers(2, 14))
        if rng.random() < 0.5:
            cv2.circle(picture, centre, radius, colour, -1, cv2.LINE_AA)
        else:
            cv2.rectangle(picture, centre, [value + radius for value in centre], colour, -1)
    side_m = 2.6 * far_m * max(camera.width_px, camera.height_px) / (2.0 * camera.fx_px)
    surface = PictureSurface(linear_of_srgb(picture).astype(np.float32), side_m, side_m)
    return Panel(Pose(TOWARDS_CAMERA, np.array([0.0, 0.0, far_m])), side_m, side_m, surface)


def _window(poses: list[Pose], camera: Camera, rng: np.random.Generator) -> Panel:
    """A pane eight times as bright as white paper, before the wall."""
    far_m = 0.95 * WALL_BEYOND * max(float(pose.position_m[2]) for pose in poses)
    place = np.append(rng.uniform(-0.3, 0.3, 2) * camera.width_px / camera.fx_px, 1.0) * far_m
    size_m = 0.35 * far_m * camera.width_px / camera.fx_px
    return Panel(Pose(TOWARDS_CAMERA, place), size_m, size_m, PlainSurface((0, 0, 0)), glow_rgb=(8.0, 8.0, 8.4))


def _sheet(code: int, pose: Pose, condition: Condition, rng: np.random.Generator) -> list[Panel]:
    """The paper with what bends, shades and covers it."""
    surface = PlateSurface.of_code(code, U_M)
    sheet = Panel(pose, SHEET_M, SHEET_M, surface, condition.glare)
    if condition.shadow_share is not None:
        angle = rng.uniform(0.0, 2.0 * np.pi)
        towards, edge_m = (float(np.cos(angle)), float(np.sin(angle))), rng.uniform(-3.0, 3.0) * U_M
        sheet = replace(sheet, surface=ShadowedSurface(surface, towards, edge_m, U_M, condition.shadow_share))
    panels = [sheet] if condition.pillar_u is None else [*bent_panels(sheet, U_M, condition.pillar_u * U_M)]
    if condition.hidden_share > 0.0:
        panels.append(_board(pose, condition.hidden_share, rng))
    if condition.hidden_base_dot:
        dot_m = dots_target_m(U_M)[rng.choice(BASE_CELLS)] + [0.0, 0.0, COVER_M_OFF]
        panels.append(_cover(pose, dot_m, (3.4 * U_M, 3.4 * U_M), rng))
    return panels


def _board(pose: Pose, share: float, rng: np.random.Generator) -> Panel:
    """Over a part of the plate, from one of its sides."""
    height_m = share * PLATE_SIDE_U * U_M + U_M
    quarter = exp_rotation(np.array([0.0, 0.0, np.pi / 2 * rng.integers(4)]))
    turned = Pose(pose.rotation @ quarter, pose.position_m)
    middle_m = np.array([0.0, -SHEET_M / 2 + height_m / 2, COVER_M_OFF])
    return _cover(turned, middle_m, (SHEET_M, height_m), rng)


def _cover(pose: Pose, at_m: Floats, size_m: tuple[float, float], rng: np.random.Generator) -> Panel:
    colour = COVERS_RGB[int(rng.integers(len(COVERS_RGB)))]
    return Panel(Pose(pose.rotation, pose.apply(at_m)), *size_m, PlainSurface(colour))


def _lamps(pose: Pose, condition: Condition, rng: np.random.Generator) -> list[Lamp]:
    """The lamp beside a plate's edge, and the one that its film mirrors."""
    lamps = []
    if condition.lamp_off_u is not None:
        off_m, angle = condition.lamp_off_u * U_M, rng.uniform(0.0, 2.0 * np.pi)
        edge_m = PLATE_SIDE_U / 2 * U_M * np.array([np.cos(angle), np.sin(angle)])
        lamps.append(Lamp(pose.apply(np.array([*edge_m, off_m])), (off_m**2, off_m**2, off_m**2)))
    if condition.glare is not None:
        spot_m = pose.apply(np.array([*rng.uniform(-4.5, 4.5, 2) * U_M, 0.0]))
        normal, sight = pose.rotation[:, 2], -spot_m / np.linalg.norm(spot_m)
        mirrored = 2.0 * (normal @ sight) * normal - sight
        distance_m = float(np.linalg.norm(spot_m))
        light = 0.5 * distance_m**2  # half as much as comes from all sides
        lamps.append(Lamp(spot_m + distance_m * mirrored, (light, light, light)))
    return lamps
