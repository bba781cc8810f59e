"""The story of an evaluation: lever arm -> clock -> pairs -> alignment -> errors -> metrics."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from app.trajectories.alignment import Alignment, AlignmentOptions, align
from app.trajectories.association import AssociationOptions, Pairs, associate
from app.trajectories.lever_arm import with_lever_arm
from app.trajectories.metrics.accuracy import Accuracy, accuracy_of
from app.trajectories.metrics.availability import Availability, availability_of
from app.trajectories.metrics.bootstrap import BootstrapOptions, Interval, interval_of
from app.trajectories.metrics.distinguishable import Verdict, verdict_on
from app.trajectories.metrics.errors import Errors, errors_of
from app.trajectories.metrics.floors import FloorScore, evaal_errors_m, floor_score
from app.trajectories.metrics.pose_errors import PoseErrors, pose_errors_of
from app.trajectories.metrics.summary import Summary, summarise
from app.trajectories.metrics.zones import Zone, accuracy_by_zone
from app.trajectories.time_offset import TimeOffset, estimate_time_offset
from app.trajectories.trajectory import Array, Trajectory


@dataclass(frozen=True)
class EvaluationOptions:
    """How a system is compared with the reference.

    Attributes
    ----------
    association : AssociationOptions
    alignment : AlignmentOptions
    time_offset_s : float or None
        The reference's clock less the estimate's; None: estimated.
    lever_arm_m : ndarray of shape (3,) or None
        From the reference's camera to the point that the system locates, in the camera's frame.
    floor_height_m : float or None
        Of a storey, where storeys are told by height.
    zones : tuple of Zone
    bootstrap : BootstrapOptions
    """

    association: AssociationOptions = field(default_factory=AssociationOptions)
    alignment: AlignmentOptions = field(default_factory=AlignmentOptions)
    time_offset_s: float | None = 0.0
    lever_arm_m: Array | None = None
    floor_height_m: float | None = None
    zones: tuple[Zone, ...] = ()
    bootstrap: BootstrapOptions = field(default_factory=BootstrapOptions)


@dataclass(frozen=True)
class Match:
    """The poses of a system beside the reference's, before anything is judged.

    Attributes
    ----------
    pairs : Pairs
        Aligned.
    time_offset : TimeOffset
        As given (sigma 0) or as estimated.
    alignment : Alignment
    availability : Availability
    """

    pairs: Pairs
    time_offset: TimeOffset
    alignment: Alignment
    availability: Availability


@dataclass(frozen=True)
class Intervals:
    """Confidence intervals of the spatial error, in metres."""

    mean: Interval
    rms: Interval
    median: Interval
    quantile_95: Interval


@dataclass(frozen=True)
class Evaluation:
    """A system beside the reference.

    Attributes
    ----------
    pairs : Pairs
        Aligned.
    time_offset : TimeOffset
        As given (sigma 0) or as estimated.
    alignment : Alignment
    errors : Errors
    accuracy : Accuracy
    intervals : Intervals
    evaal : Summary
        Of EvAAL's errors; its ``quantile_75`` is the score.
    floors : FloorScore or None
    availability : Availability
    pose_errors : PoseErrors
    zones : dict of Accuracy by name
    verdict : Verdict or None
        None when the reference told no covariances.
    """

    pairs: Pairs
    time_offset: TimeOffset
    alignment: Alignment
    errors: Errors
    accuracy: Accuracy
    intervals: Intervals
    evaal: Summary
    floors: FloorScore | None
    availability: Availability
    pose_errors: PoseErrors
    zones: dict[str, Accuracy]
    verdict: Verdict | None


def evaluate(reference: Trajectory, estimate: Trajectory, options: EvaluationOptions | None = None) -> Evaluation:
    """Compare a system's trajectory with the reference.

    Raises
    ------
    NothingMatched
        When no pose has a partner.
    DegenerateGeometry
        When the pairs do not fix the alignment or the clock's offset.
    InvalidInput
        When orientations are needed and missing.
    """
    options = options or EvaluationOptions()
    return judge(match(reference, estimate, options), options)


def match(reference: Trajectory, estimate: Trajectory, options: EvaluationOptions) -> Match:
    """The first half of ``evaluate``: lever arm, clock, pairs, alignment."""
    if options.lever_arm_m is not None:
        reference = with_lever_arm(reference, options.lever_arm_m)
    offset = _time_offset(reference, estimate, options)
    matched = associate(reference, estimate, options.association, offset.offset_s)
    alignment = align(matched, options.alignment)
    return Match(
        pairs=replace(matched, estimate=alignment.apply(matched.estimate)),
        time_offset=offset,
        alignment=alignment,
        availability=availability_of(
            reference.times_s, estimate.shifted(offset.offset_s), options.association.max_gap_s
        ),
    )


def judge(found: Match, options: EvaluationOptions) -> Evaluation:
    """The second half of ``evaluate``: errors and metrics; the same match gives the same numbers at any time."""
    pairs, errors = found.pairs, errors_of(found.pairs)
    floors = floor_score(pairs, options.floor_height_m)
    return Evaluation(
        pairs=pairs,
        time_offset=found.time_offset,
        alignment=found.alignment,
        errors=errors,
        accuracy=accuracy_of(errors),
        intervals=_intervals(errors.spatial_m, options.bootstrap),
        evaal=summarise(evaal_errors_m(errors, floors)),
        floors=floors,
        availability=found.availability,
        pose_errors=pose_errors_of(pairs),
        zones=accuracy_by_zone(errors, pairs.reference.positions_m, options.zones),
        verdict=verdict_on(errors),
    )


def _time_offset(reference: Trajectory, estimate: Trajectory, options: EvaluationOptions) -> TimeOffset:
    if options.time_offset_s is not None:
        return TimeOffset(options.time_offset_s, 0.0)
    return estimate_time_offset(reference, estimate, options.association, options.alignment)


def _intervals(distances_m: Array, options: BootstrapOptions) -> Intervals:
    return Intervals(
        mean=interval_of(distances_m, lambda values: values.mean(axis=-1), options),
        rms=interval_of(distances_m, lambda values: np.sqrt((values**2).mean(axis=-1)), options),
        median=interval_of(distances_m, lambda values: np.median(values, axis=-1), options),
        quantile_95=interval_of(distances_m, lambda values: np.quantile(values, 0.95, axis=-1), options),
    )
