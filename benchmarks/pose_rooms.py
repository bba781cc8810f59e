"""Whether covariances of poses hold in rendered rooms: ``python -m benchmarks.pose_rooms``.

Rooms of several sizes, cameras, lights and plates are rendered, detected and located. Map, datum and camera are the
truth, redrawn for each photograph with the errors that a survey leaves, so that photographs are independent: the mean
normalised error squared is 6 when the covariance is honest. Beside it stand the errors that a plate's dots share, in
units of what the detector says of them (1 when it says the truth).
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.errors import NotLocated
from app.geometry.camera import CalibratedCamera, Camera
from app.geometry.observations import Detection
from app.geometry.plate_sigmas import LINEAR, SHIFT
from app.geometry.pose import Pose
from app.geometry.rotation import exp_rotation
from app.geometry.target_map import Datum, MappedTarget, TargetMap
from app.photogrammetry.plate_correlation import plate_basis
from app.photogrammetry.resection import resect
from app.photogrammetry.sightings import whitening_of
from app.planning.imaging import ImagingOptions
from app.planning.posting import RoomOptions
from app.planning.room import build_room
from app.planning.scene import Scene
from app.planning.survey_plan import StationOptions, phone_camera, plan_stations
from app.planning.synthetic import render
from app.targets.family import family_by_name
from app.vision.detector import detect
from app.vision.photo import load_photo
from benchmarks.pose_scene import moved, pose_error

Array = npt.NDArray[np.float64]

FAMILY = "golay"
OWN_SIGMAS = np.array([2e-4] * 3 + [6e-4] * 3)  # m, rad: of a target in the map of some 50 photographs
DATUM_SIGMAS = np.array([5e-4] * 3 + [1e-4] * 3 + [1e-4])  # m, rad, log-scale: four control points of 1 mm
INTRINSIC_SIGMAS = np.array([0.8, 0.8, 0.6, 0.6, 2e-3, 4e-3, 1e-4, 1e-4, 3e-3])
FAR_OFF_PX = 3.0  # a centre further off than this is another dot's


@dataclass(frozen=True)
class Kind:
    """A room, a phone and its light."""

    room: RoomOptions
    size_px: tuple[int, int]
    imaging: ImagingOptions


KINDS = (
    Kind(RoomOptions(), (1920, 1080), ImagingOptions()),
    Kind(RoomOptions((7.0, 5.0, 2.8), 70), (1920, 1080), ImagingOptions(lens_sigma_px=0.5, sharpening=0.5)),
    Kind(RoomOptions((6.0, 5.0, 2.6), 60, u_m=0.008), (2592, 1944), ImagingOptions(lens_sigma_px=0.9, chroma="4:4:4")),
    Kind(RoomOptions((4.0, 4.0, 2.6), 30), (1600, 1200), ImagingOptions(exposure_ev=-0.7, full_well_electrons=1500.0)),
)


def main() -> int:
    """Render, locate, print."""
    parser = argparse.ArgumentParser(prog="pose_rooms", description=__doc__)
    parser.add_argument("--photos", type=int, default=12, help="of each room")
    parser.add_argument("--seed", type=int, default=11)
    arguments = parser.parse_args()
    print("room  located  targets  rmse mm    NEES   shift  linear    dots", flush=True)
    everything = []
    for number, kind in enumerate(KINDS):
        rows = _rows(kind, arguments.photos, arguments.seed + number)
        _print(str(number + 1), rows)
        everything.append(rows)
    _print("all", np.concatenate(everything))
    return 0


def _rows(kind: Kind, photos: int, seed: int) -> Array:
    """Targets, squared error of the position, normalised error squared, and parted dot errors of each photograph."""
    family, camera = family_by_name(FAMILY), phone_camera(*kind.size_px)
    scene, rng = build_room(kind.room, family, seed), np.random.default_rng(seed)
    rows = []
    for pose in plan_stations(kind.room.size_m, StationOptions(), seed)[:photos]:
        photo = load_photo(render(scene, camera, pose, kind.imaging, seed).jpeg)
        seen = detect(photo.bgr, family)
        try:
            located = resect(seen.targets, _redrawn_map(scene, rng), _redrawn_camera(camera, rng))
        except NotLocated:
            continue
        error = pose_error(located.site_from_cam, pose)
        nees = error @ np.linalg.solve(located.covariance, error)
        rows.append([len(seen.targets), error[:3] @ error[:3], nees, *_parted(seen, scene, camera, pose)])
    return np.array(rows)


def _redrawn_map(scene: Scene, rng: np.random.Generator) -> TargetMap:
    """The true map with errors of a survey: each target's own, and a datum that all share."""
    datum = Datum(np.zeros(3), np.diag(DATUM_SIGMAS**2))
    shift = DATUM_SIGMAS * rng.normal(size=7)
    targets = []
    for posted in (target for target in scene.targets if not target.wrong):
        own = np.diag(OWN_SIGMAS**2)
        target = MappedTarget(posted.code, posted.site_from_target, posted.dots_m(), own, rays=9, rms_px=0.1)
        target = moved(target, OWN_SIGMAS * rng.normal(size=6))
        centre_m = target.site_from_target.position_m
        turned = exp_rotation(shift[3:6]) @ target.site_from_target.rotation
        placed = Pose(turned, centre_m + datum.point_jacobian(centre_m) @ shift)
        dots_m = target.dots_m + datum.point_jacobian(target.dots_m) @ shift
        targets.append(replace(target, site_from_target=placed, dots_m=dots_m))
    return TargetMap(tuple(targets), datum, FAMILY, scene.targets[0].u_m)


def _redrawn_camera(camera: Camera, rng: np.random.Generator) -> CalibratedCamera:
    intrinsics = camera.intrinsics + INTRINSIC_SIGMAS * rng.normal(size=9)
    return CalibratedCamera(camera.with_intrinsics(intrinsics), np.diag(INTRINSIC_SIGMAS**2), "survey")


def _parted(seen: Detection, scene: Scene, camera: Camera, site_from_cam: Pose) -> Array:
    """Squares of shifts, linear deformations and single dots, and their numbers, in units of what is said of them."""
    posted, parted = {target.code: target for target in scene.targets}, np.zeros(6)
    for target in seen.targets:
        true_px = camera.project(site_from_cam.inverse().apply(posted[target.code].dots_m()))
        errors_px = np.where(target.measured[:, None], target.centres_px - true_px, 0.0)
        if np.abs(errors_px).max() > FAR_OFF_PX:
            continue
        whitening, sigmas = whitening_of(target), target.plate_sigmas
        whitened = (whitening @ errors_px[..., None]).ravel()
        modes = plate_basis(whitening[None])[0].T @ whitened
        rest = (whitened @ whitened - modes @ modes) / sigmas.dots**2
        of_modes = (modes / sigmas.of_modes) ** 2
        parted += [of_modes[SHIFT].sum(), of_modes[LINEAR].sum(), rest, 2, 4, 2 * target.measured.sum() - 6]
    return parted


def _print(name: str, rows: Array) -> None:
    if not len(rows):
        print(f"{name:4s}  none located")
        return
    sigmas = np.sqrt(rows[:, 3:6].sum(axis=0) / rows[:, 6:9].sum(axis=0))
    rmse_mm = 1000.0 * np.sqrt(rows[:, 1].mean())
    parts = " ".join(f"{sigma:7.2f}" for sigma in sigmas)
    targets, nees = rows[:, 0].mean(), rows[:, 2].mean()
    print(f"{name:4s} {len(rows):8d} {targets:8.1f} {rmse_mm:8.2f} {nees:7.2f} {parts}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
