"""``scattermark locate``: snapshots to poses with a map file, without the service."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.cli.arguments import add_json, photo_files
from app.cli.compile_ import compile_first
from app.cli.located_trajectory import check_suffix, exif_seconds, write_trajectory
from app.cli.progress import progress
from app.errors import NotLocated

if TYPE_CHECKING:
    from app.geometry.camera import CalibratedCamera
    from app.geometry.map_file import MapFile
    from app.photogrammetry.resection import Resection
    from app.services.choose_camera import KnownCameras

MM_PER_M = 1000.0


HELP = "locate snapshots in a target map"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("photos", type=Path, nargs="+", help="snapshots, or folders of them")
    parser.add_argument("--map", type=Path, required=True, metavar="MAP.json", help="what `scattermark build` wrote")
    parser.add_argument(
        "--camera",
        type=Path,
        metavar="CAMERA.json",
        help="what `scattermark calibrate` wrote, or intrinsics: width_px, height_px, fx, fy, cx, cy, dist, readout_s",
    )
    parser.add_argument(
        "--trajectory", type=Path, metavar="FILE.csv|.tum", help="write the poses by their EXIF times, taken as UTC"
    )
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Locate each; 1 when one of them was refused."""
    compile_first()
    from app.cli.camera_file import read_camera
    from app.geometry.map_file import read_map

    if arguments.trajectory is not None:
        check_suffix(arguments.trajectory)
    content = read_map(arguments.map)
    named = read_camera(arguments.camera) if arguments.camera else None
    records = _locate_all(photo_files(arguments.photos), content, named)
    if arguments.trajectory is not None:
        _write(arguments.trajectory, records)
    if arguments.json:
        print(json.dumps(records))
    else:
        for record in records:
            print(_line(record))
    return 0 if all("reason" not in record for record in records) else 1


def _write(path: Path, records: Sequence[dict[str, Any]]) -> None:
    located = [record for record in records if "reason" not in record]
    write_trajectory(
        path, [{**record, "time_s": exif_seconds(record["photo"], record["captured_at"])} for record in located]
    )


def _locate_all(paths: Sequence[Path], content: MapFile, named: CalibratedCamera | None) -> list[dict[str, Any]]:
    from app.cli.locate_photo import known_cameras

    known, records = known_cameras(content, named), []
    with progress() as report:
        for done, path in enumerate(paths, start=1):
            records.append(_record(path, content, known))
            report("locating", done, len(paths))
    return records


def _record(path: Path, content: MapFile, known: KnownCameras) -> dict[str, Any]:
    from app.cli.locate_photo import detect_in_map, resect_in_map
    from app.cli.read_photo import read_photo
    from app.services.best_pose import rolling_shutter_of

    photo = read_photo(path)
    of_photo = {"photo": path.name, "captured_at": photo.captured_at}
    try:
        best = resect_in_map(photo, detect_in_map(photo, content), content, known)
    except NotLocated as refusal:
        return {**of_photo, "detail": refusal.detail, **refusal.fields}
    shutter = asdict(rolling_shutter_of(best, content.target_map))
    return {
        **of_photo,
        **_pose(best.resection),
        "camera_source": best.camera.source,
        "rolling_shutter": shutter,
    }


def _pose(resection: Resection) -> dict[str, Any]:
    import numpy as np

    from app.geometry.rotation import photogrammetric_angles_deg

    pose = resection.site_from_cam
    angles_deg = photogrammetric_angles_deg(pose.rotation)
    return {
        "position_m": pose.position_m.tolist(),
        "orientation_xyzw": pose.orientation_xyzw.tolist(),
        "angles_deg": None if angles_deg is None else dict(zip(("phi", "omega", "kappa"), angles_deg, strict=True)),
        "covariance": resection.covariance.tolist(),
        "position_sigma_m": np.sqrt(np.diag(resection.covariance)[:3]).tolist(),
        "targets": [
            {"code": target.code, "rms_px": target.rms_px, "used": target.used} for target in resection.targets
        ],
        "sigma0": resection.sigma0,
        "redundancy": resection.redundancy,
        "rms_residual_px": resection.rms_residual_px,
        "ambiguity_ratio": resection.ambiguity_ratio,
    }


def _line(record: dict[str, Any]) -> str:
    if "reason" in record:
        return f"{record['photo']}: not located ({record['reason']}): {record['detail']}"
    x_m, y_m, z_m = record["position_m"]
    sigma_mm = " ".join(f"{MM_PER_M * sigma_m:.1f}" for sigma_m in record["position_sigma_m"])
    used = sum(target["used"] for target in record["targets"])
    turned = record["angles_deg"]
    angles = "" if turned is None else " ".join(f"{name} {value:.2f}" for name, value in turned.items()) + " deg, "
    return (
        f"{record['photo']}: {x_m:.4f} {y_m:.4f} {z_m:.4f} m +- {sigma_mm} mm, {angles}{used} targets, "
        f"rms {record['rms_residual_px']:.3f} px, camera from {record['camera_source']}"
    )
