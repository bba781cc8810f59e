"""``scattermark calibrate``: photographs of a mapped site to their camera, with a map file or a service's database."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.cli.arguments import add_data_dir, add_json, add_workers, non_negative, photo_files
from app.cli.compile_ import compile_first
from app.cli.progress import progress

if TYPE_CHECKING:
    from app.geometry.target_map import TargetMap
    from app.photogrammetry.calibration.calibrate import Calibration

PERCENT = 100.0

HELP = "calibrate a camera by photographs of a mapped site"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("photos", type=Path, nargs="+", help="5 to 20 photographs, or folders of them")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--map", type=Path, metavar="MAP.json", help="what `scattermark build` wrote")
    where.add_argument("--site", metavar="ID", help="a site of this installation; the camera is kept with it")
    parser.add_argument("--device", metavar="ID", help="with --site: whose camera it is")
    parser.add_argument(
        "--readout-s", type=non_negative, metavar="S", help="how long the sensor takes to read its rows, where known"
    )
    parser.add_argument("--out", type=Path, metavar="CAMERA.json", help="where the camera goes, for `locate --camera`")
    add_workers(parser)
    add_data_dir(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Detect each, calibrate, write."""
    compile_first()
    paths = photo_files(arguments.photos)
    from app.cli.calibrate_site import SiteOfInstallation
    from app.geometry.map_file import read_map
    from app.services.calibrate_work import calibration_to_json

    if arguments.map:
        calibration = _calibrated(paths, read_map(arguments.map).target_map, arguments.workers)
        kept = {}
    else:
        site = SiteOfInstallation(arguments.data_dir, arguments.site)
        version, target_map = site.active_map()
        calibration = _calibrated(paths, target_map, arguments.workers)
        kept = {"camera_id": site.keep(calibration, version, arguments.device, arguments.readout_s)}
    record = {**kept, **calibration_to_json(calibration), "readout_s": arguments.readout_s}
    if arguments.out:
        arguments.out.write_text(json.dumps(record))
    print(json.dumps(record) if arguments.json else "\n".join(_lines(record)))
    return 0


def _calibrated(paths: list[Path], target_map: TargetMap, workers: int) -> Calibration:
    from app.cli.detect_file import detect_file
    from app.cli.in_parallel import in_parallel
    from app.photogrammetry.calibration.calibrate import calibrate_camera
    from app.vision.detectors import choose_detector

    detector = choose_detector("default", known_codes=frozenset(target_map.by_code))
    with progress() as report:
        constants = (target_map.code_family, detector)
        photos = in_parallel(detect_file, paths, constants, workers, report)
        return calibrate_camera(photos, target_map, progress=report)


def _lines(record: dict[str, Any]) -> list[str]:
    """The calibration for a person."""
    sigmas = [record["covariance"][index][index] ** 0.5 for index in range(4)]
    name = f"{record['make']} {record['model']}".strip() or "camera"
    lines = [f"{name}, {record['width_px']} x {record['height_px']} px:"]
    lines += [
        f"  {intrinsic} {record[intrinsic]:.2f} px, sigma {sigma:.2f} px"
        for intrinsic, sigma in zip(("fx", "fy", "cx", "cy"), sigmas, strict=True)
    ]
    lines.append("  k1, k2, p1, p2, k3: " + ", ".join(f"{value:.5f}" for value in record["dist"]))
    lines.append(
        f"  from {len(record['photographs'])} photographs of {record['targets']} targets, residuals "
        f"{record['rms_residual_px']:.3f} px; between photographs the focal length scatters by "
        f"{PERCENT * record['focal_scatter']:.2g} %"
    )
    if record["not_carried"]:
        lines.append(f"  hardly better known than before: {', '.join(record['not_carried'])}")
    lines += [f"  left out: {photo['name']} ({photo['reason']}): {photo['detail']}" for photo in record["left_out"]]
    lines += [
        f"  target {target['code']}: {target['refused']} of {target['seen']} photographs say it was moved or misread"
        for target in record["refused_targets"]
    ]
    return lines
