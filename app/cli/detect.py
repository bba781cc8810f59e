"""``scattermark detect``: what is seen in one photograph, and what was refused and why."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.cli.arguments import add_json, add_reading
from app.cli.compile_ import compile_first

if TYPE_CHECKING:
    from app.geometry.observations import Detection


HELP = "find the targets in a photograph"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("photo", type=Path)
    parser.add_argument("--overlay", type=Path, metavar="OUT.png", help="draw what was found and what was refused")
    add_reading(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Detect, draw, print."""
    compile_first()
    from app.cli.read_photo import read_photo
    from app.targets.family import family_by_name
    from app.vision.detectors import choose_detector

    path = arguments.photo
    detector = choose_detector(arguments.detector, arguments.strictness)
    photo = read_photo(path)
    detection = detector.detect(photo.bgr, family_by_name(arguments.family))
    if arguments.overlay is not None:
        _write_overlay(arguments.overlay, photo.bgr, detection)
    if arguments.json:
        print(json.dumps(_to_json(path, detection)))
    else:
        _print(path, detection)
    return 0


def _write_overlay(path: Path, bgr: Any, detection: Detection) -> None:
    import cv2

    from app.errors import InvalidInput
    from app.vision.overlay import draw_detection

    if not cv2.haveImageWriter(path.name):
        raise InvalidInput(f"{path.name} has no suffix of a picture: write to a .png or .jpg")
    _, encoded = cv2.imencode(path.suffix, draw_detection(bgr, detection))
    path.write_bytes(encoded.tobytes())


def _to_json(path: Path, detection: Detection) -> dict[str, Any]:
    from app.geometry.observations import observation_to_json

    return {
        "photo": path.name,
        "width_px": detection.width_px,
        "height_px": detection.height_px,
        "targets": [observation_to_json(target) for target in detection.targets],
        "rejected": [
            {
                "reason": rejected.reason,
                "detail": rejected.detail,
                "code": rejected.code,
                "centre_px": rejected.centre_px.tolist(),
            }
            for rejected in detection.rejected
        ],
    }


def _print(path: Path, detection: Detection) -> None:
    print(f"{path.name}: {len(detection.targets)} targets, {len(detection.rejected)} refused")
    if detection.targets:
        print(f"{'code':>8} {'centre px':>17} {'dots':>5} {'corrected':>10} {'hidden':>7} {'rms px':>7}")
    for target in sorted(detection.targets, key=lambda one: one.code):
        x_px, y_px = target.centre_px
        counts = f"{target.measured.sum():5d} {target.corrected:10d} {target.erased:7d}"
        print(f"{target.code:8d} {x_px:8.1f} {y_px:8.1f} {counts} {target.rms_px:7.3f}")
    for rejected in detection.rejected:
        x_px, y_px = rejected.centre_px
        code = "" if rejected.code is None else f" (code {rejected.code})"
        detail = f": {rejected.detail}" if rejected.detail else ""
        print(f" refused {x_px:8.1f} {y_px:8.1f} {rejected.reason}{code}{detail}")
