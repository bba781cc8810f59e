"""What photographs of a synthetic building show: observations with noise as a detector states it, and no pixels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from app.geometry.camera import Camera, CameraIdentity
from app.geometry.control import ControlPoint, Role
from app.geometry.observations import Detection, TargetObservation
from app.geometry.plate_sigmas import PlateSigmas
from app.geometry.pose import Pose
from app.photogrammetry.plate_correlation import plate_basis
from app.photogrammetry.survey_input import SurveyPhoto
from app.targets.layout import BASE_CELLS, BASE_NAMES, DOT_COUNT, dots_target_m
from benchmarks.building import Building

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

U_M = 0.014
BREATH = 1  # seeds a photograph's focus apart from its noise
WAVES = 2.0  # of the lens's error across the picture
FIELD = 0.9  # greatest tangent off the axis: beyond it the lens's polynomial means nothing


@dataclass(frozen=True)
class Phone:
    """A true camera, and what its photographs tell of it: neither distortion nor more than the focal length's rough."""

    identity: CameraIdentity
    camera: Camera


PHONES = (
    Phone(
        CameraIdentity("Acme", "Phone", 2592, 1944, 4.0, 26.0),
        Camera(2592, 1944, np.array([1812.0, 1812.6, 1301.0, 961.0, 0.09, -0.19, 0.0006, -0.0009, 0.05])),
    ),
    Phone(
        CameraIdentity("Bolt", "Tablet", 1920, 1080, 4.4, 27.0),
        Camera(1920, 1080, np.array([1395.0, 1394.6, 951.0, 547.0, -0.05, 0.08, -0.0004, 0.0005, -0.03])),
    ),
)


@dataclass(frozen=True)
class ViewOptions:
    """What a detector reads, and how well.

    Attributes
    ----------
    sigma_px : float
        Stated standard deviation of a dot's coordinates.
    errors : PlateSigmas
        True errors of a plate's shift, linear deformation and single dots, as multiples of what is stated.
    least_px_per_u : float
        Smallest image that is read.
    most_incidence_rad : float
    coloured : float
        Share of the digits' dots that are white or green; black ones are no dots.
    margin_px : float
        A plate nearer to the frame's edge is not read.
    tablet_every : int
        Every so many photographs are taken with the second phone; 0: none.
    breathes : float
        Standard deviation of the focal length from photograph to photograph, a share of it.
    wave_px : float
        By how much the lens's image is off what its polynomial says: a wave twice across the picture.
    """

    sigma_px: float = 0.1
    errors: PlateSigmas = field(default_factory=lambda: PlateSigmas(1.5, 1.2, 0.9))
    least_px_per_u: float = 2.2
    most_incidence_rad: float = float(np.deg2rad(70.0))
    coloured: float = 2.0 / 3.0
    margin_px: float = 8.0
    tablet_every: int = 5
    breathes: float = 0.0
    wave_px: float = 0.0


@dataclass(frozen=True)
class Plates:
    """Plates as arrays: codes (T,), ``site_from_target`` rotations (T, 3, 3), centres and all dots (T, 16, 3), site."""

    codes: npt.NDArray[np.intp]
    rotations: Array
    centres_m: Array
    dots_m: Array

    @classmethod
    def of(cls, building: Building, plates_m: dict[int, Array]) -> Plates:
        """Of a building; ``plates_m``: dots (16, 3), plate frame, of plates that are not as designed."""
        poses, designed = building.plates, dots_target_m(U_M)
        return cls(
            np.array(list(poses), dtype=np.intp),
            np.array([pose.rotation for pose in poses.values()]),
            np.array([pose.position_m for pose in poses.values()]),
            np.array([pose.apply(plates_m.get(code, designed)) for code, pose in poses.items()]),
        )


def photograph(
    building: Building, options: ViewOptions, seed: int, plates_m: dict[int, Array] | None = None
) -> tuple[SurveyPhoto, ...]:
    """Every station's photograph, named by its number; the noise of each depends on the seed and its number alone."""
    plates = Plates.of(building, plates_m or {})
    nearby = KDTree(plates.centres_m[:, :2])
    wall_middles = KDTree(building.walls_m.mean(axis=1))
    longest_m = float(np.linalg.norm(np.diff(building.walls_m, axis=1), axis=-1).max())
    photos = []
    for number, station in enumerate(building.stations):
        phone = PHONES[int(options.tablet_every > 0 and number % options.tablet_every == options.tablet_every - 1)]
        reach_m = phone.camera.fx_px * U_M / options.least_px_per_u
        near = np.array(sorted(nearby.query_ball_point(station.position_m[:2], reach_m)), dtype=np.intp)
        walls = building.walls_m[wall_middles.query_ball_point(station.position_m[:2], reach_m + longest_m)]
        near = near[~_hidden(station.position_m[:2], plates.centres_m[near, :2], walls)]
        rng = np.random.default_rng((seed, number))
        camera = _breathing(phone.camera, options.breathes, np.random.default_rng((seed, number, BREATH)))
        seen = tuple(_observed(plates, near, (station, camera), options, rng))
        detection = Detection(phone.camera.width_px, phone.camera.height_px, seen)
        photos.append(SurveyPhoto(f"photo{number:05d}.jpg", phone.identity, detection))
    return tuple(photos)


def _breathing(camera: Camera, share: float, rng: np.random.Generator) -> Camera:
    """A camera as it is focused for one photograph."""
    intrinsics = camera.intrinsics.copy()
    intrinsics[:2] *= 1.0 + share * rng.normal()
    return camera.with_intrinsics(intrinsics)


def _waved(dots_px: Array, camera: Camera, wave_px: float) -> Array:
    """Where a lens that its polynomial does not describe images dots, shape (..., 2)."""
    phase_rad = WAVES * 2.0 * np.pi * dots_px / np.array([camera.width_px, camera.height_px])
    return np.asarray(dots_px + wave_px * np.sin(phase_rad[..., ::-1]))


def _hidden(eye_m: Array, points_m: Array, walls_m: Array) -> Mask:
    """Which of the points (n, 2) stand behind a wall (w, 2, 2), in plan."""
    along = walls_m[:, 1] - walls_m[:, 0]
    sight = points_m - eye_m
    to_wall = walls_m[:, 0] - eye_m
    across = sight[:, None, 0] * along[:, 1] - sight[:, None, 1] * along[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):  # a sight along a wall crosses it nowhere
        on_sight = (to_wall[:, 0] * along[:, 1] - to_wall[:, 1] * along[:, 0]) / across
        on_wall = (to_wall[:, 0] * sight[:, None, 1] - to_wall[:, 1] * sight[:, None, 0]) / across
    return np.asarray(((on_sight > 0) & (on_sight < 1) & (on_wall >= 0) & (on_wall <= 1)).any(axis=1))


def _observed(
    plates: Plates, near: npt.NDArray[np.intp], eye: tuple[Pose, Camera], options: ViewOptions, rng: np.random.Generator
) -> Iterator[TargetObservation]:
    """The plates that are wholly in view, large and frontal enough."""
    station, camera = eye
    cam_m = station.inverse().apply(plates.dots_m[near].reshape(-1, 3)).reshape(-1, DOT_COUNT, 3)
    rays_m = station.position_m - plates.centres_m[near]
    frontal = (rays_m * plates.rotations[near][..., 2]).sum(axis=-1) / np.linalg.norm(rays_m, axis=-1)
    depth_m = cam_m[..., 2]
    ahead = (depth_m > np.abs(cam_m[..., :2]).max(axis=-1) / FIELD).all(axis=-1)
    large = camera.fx_px * U_M > options.least_px_per_u * depth_m.mean(axis=-1)
    shown = np.flatnonzero(ahead & large & (frontal > np.cos(options.most_incidence_rad)))
    dots_px = camera.project(cam_m[shown].reshape(-1, 3)).reshape(-1, DOT_COUNT, 2)
    dots_px = _waved(dots_px, camera, options.wave_px)
    last_px = np.array([camera.width_px, camera.height_px]) - 1.0 - options.margin_px
    whole = ((dots_px > options.margin_px) & (dots_px < last_px)).all(axis=(1, 2))
    for target, true_px in zip(near[shown[whole]], dots_px[whole], strict=True):
        measured = rng.random(DOT_COUNT) < options.coloured
        measured[list(BASE_CELLS)] = True
        covariances = np.tile(np.eye(2) * options.sigma_px**2, (DOT_COUNT, 1, 1))
        code, errors_px = int(plates.codes[target]), _errors_px(measured, options, rng)
        yield TargetObservation(code, true_px + errors_px, covariances, measured)


def _errors_px(measured: Mask, options: ViewOptions, rng: np.random.Generator) -> Array:
    """Errors of sixteen dots with the shared parts that real plates show."""
    errors = options.errors
    basis = plate_basis(measured[None, :, None, None] * np.eye(2))[0]
    single = rng.normal(size=2 * DOT_COUNT)
    shared = basis @ ((errors.of_modes - errors.dots) * (basis.T @ single))
    return np.asarray(options.sigma_px * (errors.dots * single + shared)).reshape(DOT_COUNT, 2)


def spread_control(building: Building, counts: tuple[int, int], sigma_m: float, seed: int) -> tuple[ControlPoint, ...]:
    """Control and check points with noise, on base dots of plates spread over the building."""
    rng = np.random.default_rng(seed)
    codes = list(building.plates)
    chosen = _spread([building.plates[code] for code in codes], sum(counts))
    return tuple(
        control_point(building, codes[at], index, ("control" if index < counts[0] else "check", sigma_m), rng)
        for index, at in enumerate(chosen)
    )


def control_point(
    building: Building, code: int, index: int, kind: tuple[Role, float], rng: np.random.Generator
) -> ControlPoint:
    """The point of that number on one of a plate's base dots; its role and the sigma of its noise in metres."""
    role, sigma_m = kind
    dot = index % len(BASE_CELLS)
    place_m = building.plates[code].apply(dots_target_m(U_M)[[BASE_CELLS[dot]]])[0]
    position_m = place_m + rng.normal(0.0, sigma_m, 3)
    return ControlPoint(f"P{index + 1}", code, BASE_NAMES[dot], position_m, sigma_m, role)


def _spread(poses: Sequence[Pose], count: int) -> list[int]:
    """Places far from each other: each next one is the farthest from all before it."""
    places_m = np.array([pose.position_m for pose in poses])
    chosen = [int(np.linalg.norm(places_m - places_m.mean(axis=0), axis=1).argmax())]
    nearest_m = np.linalg.norm(places_m - places_m[chosen[0]], axis=1)
    while len(chosen) < count:
        chosen.append(int(nearest_m.argmax()))
        nearest_m = np.minimum(nearest_m, np.linalg.norm(places_m - places_m[chosen[-1]], axis=1))
    return chosen
