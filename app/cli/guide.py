"""``scattermark guide``: what photographs of a survey lack so far, and from where to photograph next."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from app.cli.arguments import add_json, add_reading, add_workers, photo_files, positive
from app.cli.build import MM_PER_M, read_control
from app.cli.compile_ import compile_first
from app.cli.progress import progress

HELP = "say which targets need more photographs, and from where"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("photos", type=Path, nargs="+", help="photographs, or folders of them")
    parser.add_argument("--control", type=Path, metavar="CSV", help="control points: places in the site's coordinates")
    parser.add_argument("--u-mm", type=positive, default=14.0, help="printed module of the plates in mm (14)")
    add_reading(parser)
    add_workers(parser)
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Detect each, grow a network, say what is lacking."""
    compile_first()
    paths = photo_files(arguments.photos)
    from app.cli.detect_file import detect_file
    from app.cli.in_parallel import in_parallel
    from app.photogrammetry.survey import PlateSpec
    from app.photogrammetry.survey_guidance import guide_survey
    from app.services.guidance_words import advice_for, place_in_words, summary_of
    from app.vision.detectors import choose_detector

    detector = choose_detector(arguments.detector, arguments.strictness)
    control = read_control(arguments.control, arguments.family) if arguments.control else ()
    with progress() as report:
        photos = in_parallel(detect_file, paths, (arguments.family, detector), arguments.workers, report)
    guidance = guide_survey(photos, control, PlateSpec(arguments.family, arguments.u_mm / MM_PER_M))
    lines = [summary_of(guidance), *(advice_for(target, guidance) for target in guidance.lacking)]
    if guidance.next_shot is not None:
        codes = ", ".join(map(str, guidance.next_shot.codes))
        lines.append(f"next: {place_in_words(guidance.next_shot.shot, guidance.frame)}, for {codes}")
    print(json.dumps(asdict(guidance), default=_plain) if arguments.json else "\n".join(lines))
    return 0


def _plain(value: object) -> object:
    tolist = getattr(value, "tolist", None)
    if tolist is None:
        raise TypeError(f"{type(value).__name__} has no JSON form")
    return tolist()
