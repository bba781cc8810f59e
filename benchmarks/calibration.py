"""How well phones are calibrated by photographing a mapped site, and what each source of a camera makes of a pose.

    python -m benchmarks.calibration [--trials 40]

The demonstration room's targets, a phone that its survey never saw, dots with 0.08 px of noise and a map that errs by
0.2 mm and 0.6 mrad per target; every trial redraws all of it. No pixels: see ``benchmarks.new_phone`` for those.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from app.errors import CalibrationFailed, NotLocated
from app.geometry.camera import CalibratedCamera, CameraIdentity
from app.geometry.observations import Detection
from app.geometry.pose import Pose
from app.geometry.readout import Readout
from app.geometry.target_map import TargetMap
from app.photogrammetry.calibration.calibrate import Calibration, SurveyPhoto, calibrate_camera
from app.photogrammetry.camera_prior import FILM_DIAGONAL_MM, camera_from_client, camera_from_exif, camera_of_model
from app.photogrammetry.rolling_shutter.resect import resect_moving
from app.planning.synthetic import identity_of
from app.targets.layout import DEFAULT_U_M
from benchmarks.calibration_scene import Walk, breathing, observe, random_walk, redrawn, true_map
from benchmarks.new_phone import new_phone, room_scene, stations_of
from benchmarks.output import print_table
from benchmarks.pose_scene import pose_error

MM_PER_M, PERCENT = 1000.0, 100.0
PHONE, SCENE = new_phone(1920, 1080), room_scene()
IDENTITY = identity_of(PHONE.camera, PHONE.imaging)
MAP = true_map(SCENE, DEFAULT_U_M)
COUNTS, BREATHINGS = (6, 12, 20), (0.0, 0.001, 0.003, 0.01)
READOUTS_S, SPEED_M_S, TURN_RAD_S = (0.0, 0.01, 0.025), 1.0, 0.5
CLIENT_FOCAL_ERROR = 0.004  # of a factory's figure, within the half per cent that it is believed to
UNIT_FOCAL_ERROR = 0.005  # between units of one model


@dataclass(frozen=True)
class Score:
    """Errors of poses."""

    rmse_m: float
    nees: float
    refused: float


def calibration_of(count: int, breathes: float, seed: int) -> Calibration:
    """A calibration with everything redrawn."""
    rng = np.random.default_rng(seed)
    photos = [
        SurveyPhoto(f"{index}.jpg", IDENTITY, observe(SCENE, breathing(PHONE.camera, breathes, rng), pose, rng))
        for index, pose in enumerate(stations_of(count, seed))
    ]
    return calibrate_camera(photos, redrawn(MAP, rng))


def intrinsics_row(count: int, breathes: float, trials: int) -> list[str]:
    """Errors of calibrations, and in units of what they say."""
    truth, focal, squares, scatter, failed = PHONE.camera.intrinsics, [], [], [], 0
    for seed in range(trials):
        try:
            found = calibration_of(count, breathes, seed)
        except CalibrationFailed:
            failed += 1
            continue
        error = found.calibrated.camera.intrinsics - truth
        focal.append([error[0], np.sqrt(found.calibrated.covariance[0, 0])])
        squares.append(error @ np.linalg.solve(found.calibrated.covariance, error))
        scatter.append(found.scatter.focal)
    errors_px, sigmas_px = np.array(focal).T
    return [
        f"{count} photographs, focus scatters by {PERCENT * breathes:g} %",
        f"{np.sqrt((errors_px**2).mean()):.2f}",
        f"{np.sqrt((sigmas_px**2).mean()):.2f}",
        f"{np.sqrt(((errors_px / sigmas_px) ** 2).mean()):.2f}",
        f"{np.mean(squares):.1f}",
        f"{PERCENT * np.mean(scatter):.2f}",
        f"{failed}/{trials}",
    ]


def pose_score(
    camera_of: Callable[[int], CalibratedCamera], trials: int, walk_of: Callable[[int], Walk | None]
) -> Score:
    """Poses of snapshots, one a trial, at random places."""
    squares, normalised, refused = [], [], 0
    for seed in range(trials):
        rng = np.random.default_rng(10_000 + seed)
        pose = stations_of(8, seed + 500)[seed % 8]
        detection = observe(SCENE, PHONE.camera, pose, rng, walk_of(seed))
        error = _error(detection, redrawn(MAP, rng), camera_of(seed), pose)
        if error is None:
            refused += 1
            continue
        squares.append(error[0])
        normalised.append(error[1])
    return Score(
        float(np.sqrt(np.mean(squares))) if squares else float("nan"),
        float(np.mean(normalised)) if normalised else float("nan"),
        refused / trials,
    )


def _error(
    detection: Detection, target_map: TargetMap, camera: CalibratedCamera, truth: Pose
) -> tuple[float, float] | None:
    """Squared error of the position, m^2, and normalised squared error of the pose; None when refused."""
    try:
        found = resect_moving(detection.targets, target_map, camera).resection
    except NotLocated:
        return None
    error = pose_error(found.site_from_cam, truth)
    return float(error[:3] @ error[:3]), float(error @ np.linalg.solve(found.covariance, error))


def _off(share: float, seed: int) -> CalibratedCamera:
    """The phone's camera with a focal length that is off, as a client or another unit tells it."""
    camera = PHONE.camera
    intrinsics = camera.intrinsics.copy()
    intrinsics[:2] *= 1.0 + share * np.random.default_rng(seed).normal()
    return camera_from_client(camera.with_intrinsics(intrinsics))


def _score_cells(score: Score) -> list[str]:
    return [f"{MM_PER_M * score.rmse_m:.2f}", f"{score.nees:.1f}", f"{PERCENT * score.refused:.0f} %"]


def camera_rows(trials: int) -> list[list[str]]:
    """Pose errors by the source of the camera."""
    calibrated = [calibration_of(12, 0.0, seed).calibrated for seed in range(min(trials, 10))]
    sources: dict[str, Callable[[int], CalibratedCamera]] = {
        "calibrated from 12 photographs": lambda seed: calibrated[seed % len(calibrated)],
        "another unit's calibration (0.5 % off)": lambda seed: camera_of_model(
            replace(_off(UNIT_FOCAL_ERROR, seed), covariance=calibrated[0].covariance)
        ),
        "the client's intrinsics (0.4 % off)": lambda seed: _off(CLIENT_FOCAL_ERROR, seed),
        "EXIF alone, by the width": lambda _: camera_from_exif(IDENTITY),
        "EXIF alone, by the diagonal": lambda _: camera_from_exif(_by_diagonal()),
    }
    return [[name, *_score_cells(pose_score(camera_of, trials, lambda _: None))] for name, camera_of in sources.items()]


def _by_diagonal() -> CameraIdentity:
    """The phone's EXIF of a maker who converts by the diagonal."""
    camera = PHONE.camera
    diagonal_px = np.hypot(camera.width_px, camera.height_px)
    return replace(IDENTITY, focal_35mm=float(round(camera.fx_px / diagonal_px * FILM_DIAGONAL_MM)))


def motion_rows(trials: int) -> list[list[str]]:
    """Pose errors of snapshots in motion, with the readout known and not."""
    known = calibration_of(12, 0.0, 0).calibrated
    rows = []
    for readout_s in READOUTS_S:
        readout = Readout(readout_s)

        def walk_of(seed: int, readout: Readout = readout) -> Walk:
            return random_walk(np.random.default_rng(seed), SPEED_M_S, TURN_RAD_S, readout)

        for name, camera in (("not known", known), ("known", replace(known, readout=readout))):
            score = pose_score(partial(_same, camera), trials, walk_of)
            rows.append([f"{MM_PER_M * readout_s:g} ms, {name}", *_score_cells(score)])
    return rows


def _same(camera: CalibratedCamera, _seed: int) -> CalibratedCamera:
    return camera


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=40)
    trials = parser.parse_args().trials
    headings = ["", "fx RMSE, px", "fx sigma, px", "ratio", "NEES (9)", "scatter found, %", "refused"]
    rows = [intrinsics_row(count, 0.0, trials) for count in COUNTS]
    rows += [intrinsics_row(12, breathes, trials) for breathes in BREATHINGS[1:]]
    print_table("Calibrations (1920 x 1080, fx 1367 px)", headings, rows)
    poses = ["", "position RMSE, mm", "NEES (6)", "refused"]
    print_table("Poses of still snapshots by what is known of the camera", poses, camera_rows(4 * trials))
    print_table("Poses at 1 m/s and 0.5 rad/s, by the sensor's readout", poses, motion_rows(4 * trials))


if __name__ == "__main__":
    main()
