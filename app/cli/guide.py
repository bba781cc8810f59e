"""``scattermark guide``: what photographs of a survey lack so far, and from where to photograph next."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict

from app.cli.arguments import add_json, add_survey, photo_files
from app.cli.compile_ import compile_first
from app.cli.progress import progress
from app.cli.survey_files import MM_PER_M, control_of, detect_all

HELP = "say which targets need more photographs, and from where"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    add_survey(parser, control="control points: places in the site's coordinates")
    add_json(parser)


def run(arguments: argparse.Namespace) -> int:
    """Detect each, grow a network, say what is lacking."""
    compile_first()
    paths = photo_files(arguments.photos)
    from app.photogrammetry.survey import PlateSpec
    from app.photogrammetry.survey_guidance import guide_survey
    from app.services.guidance_words import advice_for, place_in_words, summary_of

    control = control_of(arguments)
    with progress() as report:
        photos = detect_all(arguments, paths, report)
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
