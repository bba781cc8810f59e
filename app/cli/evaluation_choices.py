"""The options of ``scattermark evaluate``: what its arguments say -> how systems are compared."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from app.cli.arguments import at_least_one, positive
from app.errors import InvalidInput

if TYPE_CHECKING:
    from app.trajectories.evaluation import EvaluationOptions
    from app.trajectories.metrics.zones import Zone

# Tests hold these equal to the library's lists, whose import is slow.
ASSOCIATIONS = ("interpolate", "nearest", "last")
COURSES = ("linear", "spline")
ALIGNMENTS = ("none", "se3", "posyaw", "sim3", "origin", "first_n")
ROTATIONS = ("positions", "orientations")
ESTIMATED = "estimate"
LEAST_CONFIDENCE, GREATEST_CONFIDENCE = 0.5, 0.999
LEAST_PAIRS = 3  # of first_n, as the library has it


def add_choices(parser: argparse.ArgumentParser) -> None:
    """Arguments in the order of the work: pairs, clock, frame, metrics."""
    parser.add_argument(
        "--association",
        choices=ASSOCIATIONS,
        default="interpolate",
        help="how poses are paired: the reference interpolated, the nearest, or EvAAL's last word (interpolate)",
    )
    parser.add_argument("--max-gap-s", type=positive, default=1.0, help="largest gap in time (1)")
    parser.add_argument("--course", choices=COURSES, default="linear", help="of interpolated positions (linear)")
    parser.add_argument(
        "--time-offset-s", type=_offset, default=0.0, help="reference's clock less the estimate's, or `estimate` (0)"
    )
    parser.add_argument("--lever-arm-m", type=float, nargs=3, metavar=("X", "Y", "Z"), help="camera to antenna")
    parser.add_argument("--alignment", choices=ALIGNMENTS, default="none", help="into the reference's frame (none)")
    parser.add_argument("--first-n", type=_pairs, default=10, metavar="N", help="pairs of the alignment first_n (10)")
    parser.add_argument(
        "--rotation-from", choices=ROTATIONS, default="positions", help="what fixes the alignment's turn (positions)"
    )
    parser.add_argument("--floor-height-m", type=positive, help="height of a storey, where storeys are told by z")
    parser.add_argument("--zones", type=Path, metavar="FILE", help='JSON: [{"name": ..., "corners_m": [[x, y], ...]}]')
    parser.add_argument("--confidence", type=_confidence, default=0.95, help="of the intervals (0.95)")
    parser.add_argument("--resamples", type=at_least_one, default=2000, help="of the bootstrap (2000)")
    parser.add_argument("--seed", type=int, default=1, help="of the bootstrap (1)")


def options_of(arguments: argparse.Namespace) -> EvaluationOptions:
    """The options.

    Raises
    ------
    InvalidInput
        When the file of zones tells none.
    """
    import numpy as np

    from app.trajectories.alignment import AlignmentOptions
    from app.trajectories.association import AssociationOptions
    from app.trajectories.evaluation import EvaluationOptions
    from app.trajectories.metrics.bootstrap import BootstrapOptions

    return EvaluationOptions(
        association=AssociationOptions(arguments.association, arguments.max_gap_s, arguments.course),
        alignment=AlignmentOptions(arguments.alignment, arguments.first_n, arguments.rotation_from),
        time_offset_s=arguments.time_offset_s,
        lever_arm_m=None if arguments.lever_arm_m is None else np.array(arguments.lever_arm_m),
        floor_height_m=arguments.floor_height_m,
        zones=() if arguments.zones is None else _zones(arguments.zones),
        bootstrap=BootstrapOptions(arguments.resamples, arguments.confidence, seed=arguments.seed),
    )


def _zones(path: Path) -> tuple[Zone, ...]:
    import json

    import numpy as np

    from app.trajectories.metrics.zones import Zone

    try:
        told = json.loads(path.read_bytes())
        return tuple(Zone(str(zone["name"]), np.array(zone["corners_m"], dtype=np.float64)) for zone in told)
    except (ValueError, TypeError, KeyError) as error:
        raise InvalidInput(
            f'{path}: no zones like [{{"name": "hall", "corners_m": [[0, 0], [5, 0], [5, 4]]}}] ({error!r})'
        ) from error


def _offset(text: str) -> float | None:
    if text == ESTIMATED:
        return None
    try:
        return float(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"seconds, or `{ESTIMATED}`, and not {text!r}") from error


def _pairs(text: str) -> int:
    count = at_least_one(text)
    if count < LEAST_PAIRS:
        raise argparse.ArgumentTypeError(f"{LEAST_PAIRS} pairs at least fix a frame, and not {text}")
    return count


def _confidence(text: str) -> float:
    share = positive(text)
    if not LEAST_CONFIDENCE <= share <= GREATEST_CONFIDENCE:
        raise argparse.ArgumentTypeError(f"a share from {LEAST_CONFIDENCE} to {GREATEST_CONFIDENCE}, and not {text}")
    return share
