"""APE and RPE in their usual parts and stretches, in few numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import get_args

from app.trajectories.association import Pairs
from app.trajectories.metrics.absolute_pose_error import Part, absolute_pose_errors, error_of_motion
from app.trajectories.metrics.relative_pose_error import Stretch, Unit, motion_errors, stretches_of
from app.trajectories.metrics.summary import Summary, summarise

DELTA = 1.0  # per frame, per metre, per second
PARTS: tuple[Part, ...] = get_args(Part)
UNITS: tuple[Unit, ...] = get_args(Unit)


@dataclass(frozen=True)
class PoseErrors:
    """Absolute and relative pose errors of aligned pairs.

    Attributes
    ----------
    absolute : dict of Summary by part
        ``trans`` (m), ``rot_deg``, ``rot_rad``, ``full`` (unitless); ``trans`` alone without orientations.
    relative : dict of dict of Summary by part, by unit of the stretch
        Over one frame, one metre of the reference's path, one second, one stretch after the other. A unit is left out
        when the pairs are shorter than one stretch, all of them without orientations.
    """

    absolute: dict[Part, Summary]
    relative: dict[Unit, dict[Part, Summary]]


def pose_errors_of(pairs: Pairs) -> PoseErrors:
    """APE and RPE of aligned pairs."""
    if pairs.reference.orientations_xyzw is None or pairs.estimate.orientations_xyzw is None:
        return PoseErrors({"trans": summarise(absolute_pose_errors(pairs, "trans"))}, {})
    absolute = {part: summarise(absolute_pose_errors(pairs, part)) for part in PARTS}
    relative = {unit: found for unit in UNITS if (found := _relative(pairs, Stretch(DELTA, unit))) is not None}
    return PoseErrors(absolute, relative)


def _relative(pairs: Pairs, stretch: Stretch) -> dict[Part, Summary] | None:
    """One motion per stretch serves all parts; None when the pairs are shorter than one stretch."""
    starts, ends = stretches_of(pairs, stretch)
    if len(starts) == 0:
        return None
    motion = motion_errors(pairs, starts, ends)
    return {part: summarise(error_of_motion(motion, part)) for part in PARTS}
